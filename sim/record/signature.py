"""Signatures of run.json: Ed25519, by the package cryptography, which the extra ``torquer[sign]`` installs.

A signature is over the bytes of run.json and lies beside it as 64 bytes: openssl can make and verify it too.
"""

from pathlib import Path
from typing import Protocol

from fsw.input.regular_file import read_regular
from sim.errors import HarnessError, needing
from sim.record.whole_file import replace_file

SUFFIX = ".sig"
LONGEST_KEY = 10_000
LONGEST_SIGNATURE = 10_000


class PrivateKey(Protocol):
    """A key that signs."""

    def sign(self, data: bytes, /) -> bytes:
        """The signature of the data."""


class PublicKey(Protocol):
    """A key that verifies a signature."""

    def verify(self, signature: bytes, data: bytes, /) -> None:
        """Raise InvalidSignature if it is not the signature of the data."""


def private_key(path: Path) -> PrivateKey:
    """The key in a PEM file as ``openssl genpkey -algorithm ed25519`` writes it.

    Raises:
        HarnessError: the file has no such key, or the package cryptography is missing.
    """
    _require_cryptography("--sign")
    from cryptography.exceptions import UnsupportedAlgorithm  # noqa: PLC0415  (optional)
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey  # noqa: PLC0415  (optional)
    from cryptography.hazmat.primitives.serialization import load_pem_private_key  # noqa: PLC0415  (optional)

    try:
        key = load_pem_private_key(_read_key("--sign", path), password=None)
    except (ValueError, TypeError, UnsupportedAlgorithm):  # TypeError: it needs a password
        key = None
    if not isinstance(key, Ed25519PrivateKey):
        raise HarnessError(f"--sign {path}: no private Ed25519 key in PEM, without password")
    return key


def public_key(path: Path) -> PublicKey:
    """The key in a PEM file as ``openssl pkey -pubout`` writes it.

    Raises:
        HarnessError: the file has no such key, or the package cryptography is missing.
    """
    _require_cryptography("--verify")
    from cryptography.exceptions import UnsupportedAlgorithm  # noqa: PLC0415  (optional)
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey  # noqa: PLC0415  (optional)
    from cryptography.hazmat.primitives.serialization import load_pem_public_key  # noqa: PLC0415  (optional)

    try:
        key = load_pem_public_key(_read_key("--verify", path))
    except (ValueError, UnsupportedAlgorithm):
        key = None
    if not isinstance(key, Ed25519PublicKey):
        raise HarnessError(f"--verify {path}: no public Ed25519 key in PEM")
    return key


def sign(path: Path, key: PrivateKey) -> None:
    """Write the signature of a file beside it.

    Raises:
        OSError: it cannot be written.
    """
    replace_file(signature_path(path), key.sign(path.read_bytes()))


def signature_fault(path: Path, key: PublicKey) -> str:
    """Why the signature of a file is not valid; empty if it is valid for the key."""
    from cryptography.exceptions import InvalidSignature  # noqa: PLC0415  (optional)

    signature = signature_path(path)
    try:
        key.verify(read_regular(signature, LONGEST_SIGNATURE), path.read_bytes())
    except FileNotFoundError:
        return f"{path.name} is not signed: there is no {signature.name} beside it"
    except OSError as error:
        return f"{signature.name} cannot be read: {error.strerror}"
    except InvalidSignature:
        return f"{signature.name} is not the signature of {path.name} by this key"
    return ""


def signature_path(path: Path) -> Path:
    """The path of the signature of a file."""
    return path.with_name(path.name + SUFFIX)


def _require_cryptography(option: str) -> None:
    with needing(option, "cryptography", "sign"):
        import cryptography  # noqa: F401, PLC0415  (optional)


def _read_key(option: str, path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(LONGEST_KEY)
    except OSError as error:
        raise HarnessError(f"{option} {path}: cannot be read: {error.strerror}") from None
