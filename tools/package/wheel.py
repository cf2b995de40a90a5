"""Packs what a build installs as a wheel: wheel.py BUILD FOLDER. It is for .ci/wheel, on Debian.

The files lie in the wheel as in any other installation, and pip puts them into the environment's prefix; a file hapgrid.pth
leads Python from its own folder to the module. Libraries that a plain Linux lacks come along in lib/hapgrid/libs, with the
font of the pictures and the licences of all that is in the programs.
"""
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
TAG = "py3-none-manylinux_2_36_x86_64"  # glibc 2.36 is that of Debian 12
# What every Linux with that glibc and a C++ compiler's runtime has.
OUTSIDE = re.compile(r"(libc|libm|libdl|libpthread|librt|ld-linux-x86-64|libstdc\+\+|libgcc_s)\.so\.\d+")
OPENED = ["libseccomp.so.2"]  # by hapgrid.apps.common.sandbox
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf"
HEADERS = ["libcli11-dev", "libeigen3-dev", "libfmt-dev", "libstdc++-12-dev", "libtomlplusplus-dev", "nlohmann-json3-dev"]


def output(*words: str) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def needed(file: Path) -> list[str]:
    """The libraries that an ELF file asks for, but for those of OUTSIDE."""
    names = re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-d", str(file)))
    return [name for name in names if not OUTSIDE.fullmatch(name)]


def is_elf(file: Path) -> bool:
    with open(file, "rb") as start:
        return start.read(4) == b"\x7fELF"


def carry(hapgrid: Path) -> list[str]:
    """Copies the libraries that the files of lib/hapgrid need to its folder libs, and lets each file look there; also those
    that Python opens. The result are the libraries' own files."""
    known = dict(re.findall(r"^\s*(\S+) \(libc6,x86-64.*\) => (\S+)$", output("/sbin/ldconfig", "-p"), re.MULTILINE))
    libs = hapgrid / "libs"
    libs.mkdir()
    carried: dict[str, str] = {}
    todo = [file for file in sorted(hapgrid.rglob("*")) if file.is_file() and is_elf(file)]

    def take(name: str) -> None:
        if name not in carried:
            carried[name] = str(Path(known[name]).resolve())
            todo.append(Path(shutil.copy(known[name], libs / name)))

    for name in OPENED:
        take(name)
    for file in todo:
        for name in needed(file):
            take(name)
        if needed(file):
            where = "$ORIGIN" if file.parent == libs else "$ORIGIN/../libs"
            subprocess.run(["patchelf", "--set-rpath", where, str(file)], check=True)
    return list(carried.values())


def licences(files: list[str], folder: Path) -> None:
    """What Debian's packages of these files, and those of which only headers are used, say of their licences."""
    # By their names alone: a package may say /lib where the file is in /usr/lib.
    owners = {line.split(":")[0] for line in output("dpkg", "-S", *(f"*/{Path(file).name}" for file in files)).splitlines()}
    for package in sorted(owners | set(HEADERS)):
        shutil.copy(f"/usr/share/doc/{package}/copyright", folder / package)


def metadata(project: dict, version: str) -> str:
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Classifier: {one}" for one in project["classifiers"]]
    for extra, packages in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {package}; extra == '{extra}'" for package in packages)]
    readme = (SOURCE / project["readme"]).read_text(encoding="utf-8")
    return "\n".join([*lines, "Description-Content-Type: text/markdown", "", readme])


def main(build: str, out: str) -> None:
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = re.search(r"^CMAKE_PROJECT_VERSION:STATIC=(.*)$", Path(build, "CMakeCache.txt").read_text(), re.MULTILINE)[1]
    with tempfile.TemporaryDirectory() as work:
        root = Path(work) / f"hapgrid-{version}"
        data, info = root / f"hapgrid-{version}.data/data", root / f"hapgrid-{version}.dist-info"
        output("cmake", "--install", build, "--strip", "--prefix", str(data))
        shutil.rmtree(data / "lib/python3")  # Debian's way to the module
        for file in (data / "share/doc").rglob("*"):
            if file.suffix in (".png", ".webp"):  # a tenth of it all
                file.unlink()
        (data / "lib/hapgrid/models/spring-fortran.so").unlink(missing_ok=True)  # for its sake libgfortran would come along
        (root / "hapgrid.pth").write_text("../../hapgrid/python\n")
        (data / "lib/hapgrid/fonts").mkdir()
        shutil.copy(FONT, data / "lib/hapgrid/fonts")
        (info / "licenses").mkdir(parents=True)
        static = re.findall(r"(/usr/lib/\S+\.a)\b", Path(build, "build.ninja").read_text())
        licences([*carry(data / "lib/hapgrid"), *{str(Path(file).resolve()) for file in static}, FONT], info / "licenses")
        shutil.copy(SOURCE / "LICENSE", info / "licenses")
        (info / "METADATA").write_text(metadata(project, version), encoding="utf-8")
        (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: hapgrid\nRoot-Is-Purelib: true\nTag: {TAG}\n")
        Path(out).mkdir(parents=True, exist_ok=True)
        print(output(sys.executable, "-m", "wheel", "pack", str(root), "--dest-dir", out), end="")


main(*sys.argv[1:])
