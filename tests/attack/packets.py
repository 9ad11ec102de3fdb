"""Hostile packets for the viewport that listens for live poses: it must drop them, and go on to its end."""
import json
import re
import shutil
import socket
import struct
import time

from running import Running

NAME = "packets"
SECONDS = 6  # of one viewport; most of a second of it is the beginning


def attack(stage, findings, random, clock, _tools):
    if shutil.which("xvfb-run") is None:
        findings.note("packets: there is no xvfb-run: left out")
        return
    while not clock.over():
        session(stage, findings, random)


def session(stage, findings, random):
    work = stage.copy()
    joints, controls = counts(stage.files["limb.safetensors"])
    log = work / "viewport.log"
    view = ["xvfb-run", "-a", stage.program, "view", "limb.safetensors", "bend.glb", "--live", "0", "--size", "160",
            "120", "--seconds", str(SECONDS)]
    # The port is said once it is open; its messages go to a file that can be read meanwhile.
    running = Running(["sh", "-c", " ".join(view) + f" >{log.name} 2>&1"], work)
    port = listening_port(log, running)
    sent = []
    if port:
        sent = flood(port, random, joints, controls, running)
    outcome = running.wait(SECONDS + 30)
    outcome.output = log.read_text(errors="replace")
    findings.attempt(NAME, len(sent))
    (work / "last_packets.json").write_text(json.dumps([packet.hex() for packet in sent[-2000:]]))
    # A shell says 128 + n of a program that was ended by signal n.
    outcome.code = 128 - outcome.code if outcome.code > 128 else outcome.code
    if findings.ended(NAME, outcome, [work]):
        return
    if not port or outcome.code != 0:
        findings.add(NAME, "losses", "the viewport did not listen, or ended with an error", [work], outcome.text())


def listening_port(log, running):
    while running.process.poll() is None and running.seconds() < SECONDS:
        if log.exists():
            found = re.search(r"listening for poses on 127\.0\.0\.1:(\d+)", log.read_text(errors="replace"))
            if found:
                return int(found.group(1))
        time.sleep(0.02)
    return None


def counts(basis):
    """Joints and controls of a basis."""
    size, = struct.unpack_from("<Q", basis)
    words = json.loads(basis[8:8 + size])["__metadata__"]
    return len(json.loads(words["joint_names"])), len(json.loads(words.get("controls", "[]")))


def flood(port, random, joints, controls, running):
    """Packets until the viewport is about to close, in bursts as a network brings them."""
    sent, sender = [], socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    while running.process.poll() is None and running.seconds() < SECONDS - 0.5:
        for _ in range(random.choice((1, 10, 300))):
            packet = hostile(random, joints, controls)
            try:
                sender.sendto(packet, ("127.0.0.1", port))
            except OSError:  # the port is shut: the viewport has ended
                break
            sent.append(packet)
        if random.random() < 0.1:
            sender.close()
            sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        time.sleep(0.002)
    sender.close()
    return sent


def hostile(random, joints, controls):
    packet = bytearray(sound(random, joints, controls))
    kind = random.randrange(6)
    if kind == 0:
        return bytes(packet)
    if kind == 1:
        return random.randbytes(random.choice((0, 1, 19, 20, 21, 100, 1400, 65507)))
    if kind == 2:
        return bytes(packet[:random.randrange(len(packet))]) + random.randbytes(random.randrange(40))
    if kind == 3:  # numbers at the edge of what they can be
        word = random.choice((0x7F800000, 0xFF800000, 0x7FC00000, 0x7F7FFFFF, 0x00000001, 0x49742400, 0xC9742400, 0))
        for _ in range(random.randint(1, 8)):
            struct.pack_into("<I", packet, 20 + 4 * random.randrange((len(packet) - 20) // 4), word)
        return bytes(packet)
    for _ in range(random.randint(1, 6)):  # of the header, or of anything
        packet[random.randrange(20 if kind == 4 else len(packet))] = random.randrange(256)
    return bytes(packet)


def sound(random, joints, controls):
    values = []
    for _ in range(joints):
        values += [random.uniform(-1, 1) for _ in range(7)] + [random.uniform(0.5, 2) for _ in range(3)]
    values += [random.uniform(-1, 1) for _ in range(controls)]
    header = struct.pack("<4sHHIiHH", b"BPOS", 1, 0, random.getrandbits(32), random.randrange(-2**31, 2**31), joints,
                         controls)
    return header + struct.pack(f"<{len(values)}f", *values)
