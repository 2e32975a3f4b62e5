"""Generates `mane.v1` from the repository's `proto/` folder, then builds the package as usual."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
PROTO = HERE.parent / "proto"
SOURCE = HERE / "src"


def generate_stubs() -> None:
    """Writes messages, type hints and stubs to `src/mane/v1`, beside its `__init__.py`."""
    import grpc_tools
    from grpc_tools import protoc

    files = sorted(PROTO.glob("mane/v1/*.proto"))
    if not files:
        raise SystemExit(f"{PROTO}/mane/v1 holds no .proto files; build from a repository checkout")
    status = protoc.main(
        [
            "protoc",
            f"-I{PROTO}",
            f"-I{Path(grpc_tools.__file__).parent / '_proto'}",
            f"--python_out={SOURCE}",
            f"--pyi_out={SOURCE}",
            f"--grpc_python_out={SOURCE}",
            *map(str, files),
        ]
    )
    if status != 0:
        raise SystemExit("the API's .proto files do not compile")


class BuildWithStubs(build_py):
    def run(self):
        generate_stubs()
        super().run()


setup(cmdclass={"build_py": BuildWithStubs})
