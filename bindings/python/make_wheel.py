"""make_wheel.py STAGED VERSION OUT: a wheel of a folder that has the package `bodyopt`, for this Python and this glibc."""

import base64
import hashlib
import pathlib
import platform
import sys
import zipfile

staged, version, out = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
python = f"cp{sys.version_info.major}{sys.version_info.minor}"
glibc = platform.libc_ver()[1].replace(".", "_")
tag = f"{python}-{python}-manylinux_{glibc}_{platform.machine()}"
about = f"bodyopt-{version}.dist-info"

files = {str(path.relative_to(staged)): path.read_bytes() for path in sorted(staged.rglob("*"))
         if path.is_file() and "__pycache__" not in path.parts}
files[f"{about}/METADATA"] = (f"Metadata-Version: 2.1\nName: bodyopt\nVersion: {version}\n"
                              "Summary: Skins that were learned of simulations, and the verbs that learn them\n"
                              "License: Apache-2.0\nRequires-Python: >=3.9\nRequires-Dist: numpy\n").encode()
files[f"{about}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: bodyopt\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
files[f"{about}/entry_points.txt"] = b"[console_scripts]\nbodyopt = bodyopt.verbs:main\n"


def line_of(name):
    digest = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(files[name])}\n"


record = f"{about}/RECORD"
files[record] = ("".join(map(line_of, sorted(files))) + f"{record},,\n").encode()
for earlier in out.glob("bodyopt-*.whl"):
    earlier.unlink()
wheel = out / f"bodyopt-{version}-{tag}.whl"
with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
    for name, data in files.items():
        entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the same files give the same bytes
        entry.compress_type = zipfile.ZIP_DEFLATED
        is_program = "/program/bin/" in name or ".so" in pathlib.Path(name).name
        entry.external_attr = (0o100755 if is_program else 0o100644) << 16
        archive.writestr(entry, data)
print(wheel)
