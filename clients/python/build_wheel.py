# SPDX-License-Identifier: Apache-2.0
"""Build backend of this folder (PEP 517): a wheel of pure Python is a zip file with three texts more. So pip installs
it without network, as on a robot; setuptools would have to be downloaded."""

import base64
import hashlib
import pathlib
import re
import zipfile

FOLDER = pathlib.Path(__file__).parent
PROJECT = dict(re.findall(r'^([\w-]+) = "(.*)"$', (FOLDER / "pyproject.toml").read_text(encoding="utf-8"), re.M))
INFO = f"{PROJECT['name']}-{PROJECT['version']}.dist-info"
METADATA = f"""Metadata-Version: 2.1
Name: {PROJECT['name']}
Version: {PROJECT['version']}
Summary: {PROJECT['description']}
License: Apache-2.0
Requires-Python: {PROJECT['requires-python']}
Description-Content-Type: text/markdown

{(FOLDER / 'README.md').read_text(encoding='utf-8')}"""
WHEEL = """Wheel-Version: 1.0
Generator: floorloc
Root-Is-Purelib: true
Tag: py3-none-any
"""


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    modules = sorted([*FOLDER.glob("floorloc/**/*.py"), FOLDER / "floorloc/py.typed"])
    files = {file.relative_to(FOLDER).as_posix(): file.read_bytes() for file in modules}
    return write_wheel(wheel_directory, files)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """pip install -e (PEP 660)."""
    return write_wheel(wheel_directory, {f"{PROJECT['name']}.pth": f"{FOLDER.resolve()}\n".encode()})


def write_wheel(folder, files):
    files = {**files, f"{INFO}/METADATA": METADATA.encode(), f"{INFO}/WHEEL": WHEEL.encode()}
    record = "".join(f"{name},sha256={digest(content)},{len(content)}\n" for name, content in files.items())
    files[f"{INFO}/RECORD"] = f"{record}{INFO}/RECORD,,\n".encode()
    name = f"{PROJECT['name']}-{PROJECT['version']}-py3-none-any.whl"
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
    return name


def digest(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
