#!/usr/bin/env python3
"""Swings a joint of a basis's skeleton and sends the poses to a viewport that listens for live poses.

    python3 send_pose.py hero.safetensors --joint LeftForeArm --port 14159

The packet is described in docs/formats.md (Live poses). Needs nothing but Python's standard library.
"""
import argparse
import itertools
import json
import math
import socket
import struct
import sys
import time

FPS = 24
SWINGS_PER_SECOND = 0.5


def read_skeleton(path):
    """Names of the joints, and for each its bind transform: translation 3, rotation 4 (x y z w), scale 3."""
    with open(path, "rb") as file:
        header_size, = struct.unpack("<Q", file.read(8))
        header = json.loads(file.read(header_size))
        joints = header["skeleton.joints"]
        rows, width = joints["shape"]
        begin, end = joints["data_offsets"]
        file.seek(8 + header_size + begin)
        numbers = struct.unpack(f"<{rows * width}d", file.read(end - begin))
    names = json.loads(header["__metadata__"]["joint_names"])
    return names, [list(numbers[width * row:width * row + 10]) for row in range(rows)]


def multiply(a, b):
    """Product of two quaternions, x y z w: b is applied first."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz]


def pose_packet(number, frame, joints):
    """A packet without controls; each of `joints` is ten numbers as in read_skeleton()."""
    header = struct.pack("<4sHHIiHH", b"BPOS", 1, 0, number, frame, len(joints), 0)
    return header + struct.pack(f"<{10 * len(joints)}f", *itertools.chain.from_iterable(joints))


def swung(joints, joint, axis, radians):
    """The joints with one of them turned about an axis of its own."""
    turn = [0.0, 0.0, 0.0, math.cos(radians / 2)]
    turn["xyz".index(axis)] = math.sin(radians / 2)
    posed = [list(numbers) for numbers in joints]
    posed[joint][3:7] = multiply(posed[joint][3:7], turn)
    return posed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("basis", help="basis (.safetensors) that the viewport shows")
    parser.add_argument("--joint", required=True, help="joint to swing")
    parser.add_argument("--port", type=int, required=True, help="port that the viewport says it listens on")
    parser.add_argument("--axis", choices="xyz", default="z", help="axis of the joint (default: z)")
    parser.add_argument("--degrees", type=float, default=30, help="how far to either side (default: 30)")
    parser.add_argument("--frames", type=int, default=240, help=f"frames to send, {FPS} a second (default: 240)")
    options = parser.parse_args()

    names, bind = read_skeleton(options.basis)
    if options.joint not in names:
        sys.exit(f"{options.basis} has no joint '{options.joint}'; it has: {', '.join(names)}")
    joint = names.index(options.joint)
    viewport = ("127.0.0.1", options.port)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        begin = time.monotonic()
        for frame in range(options.frames):
            swing = math.sin(2 * math.pi * SWINGS_PER_SECOND * frame / FPS)
            posed = swung(bind, joint, options.axis, math.radians(options.degrees) * swing)
            sender.sendto(pose_packet(frame, frame, posed), viewport)
            time.sleep(max(0, begin + (frame + 1) / FPS - time.monotonic()))


if __name__ == "__main__":
    main()
