"""Signatures of a file: who may read a key, what verifies, and what openssl makes of it."""

import os
import shutil
import subprocess
import sys

import pytest

from sim.errors import HarnessError
from sim.record import signature
from sim.record.signature import private_key, public_key, sign, signature_fault, signature_path

serialization = pytest.importorskip("cryptography.hazmat.primitives.serialization")
from cryptography.hazmat.primitives.asymmetric import ec, ed448, ed25519  # noqa: E402  (only where it is installed)

PEM = serialization.Encoding.PEM
PKCS8 = serialization.PrivateFormat.PKCS8
PLAIN = serialization.NoEncryption()


def pem(key, encryption=PLAIN):
    return key.private_bytes(PEM, PKCS8, encryption)


def public_pem(key):
    return key.public_key().public_bytes(PEM, serialization.PublicFormat.SubjectPublicKeyInfo)


@pytest.fixture
def files(tmp_path):
    """A file, and the two halves of a key."""
    key = ed25519.Ed25519PrivateKey.generate()
    (tmp_path / "key.pem").write_bytes(pem(key))
    (tmp_path / "public.pem").write_bytes(public_pem(key))
    (tmp_path / "run.json").write_text('{"a": 1}\n')
    return tmp_path


def test_what_one_half_signs_the_other_verifies(files):
    run = files / "run.json"
    sign(run, private_key(files / "key.pem"))
    assert len(signature_path(run).read_bytes()) == 64
    assert signature_fault(run, public_key(files / "public.pem")) == ""


def test_every_byte_of_the_file_and_of_the_signature_counts(files):
    run, key = files / "run.json", public_key(files / "public.pem")
    sign(run, private_key(files / "key.pem"))
    for path in (run, signature_path(run)):
        content = path.read_bytes()
        for place in range(len(content)):
            path.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
            assert signature_fault(run, key) == "run.json.sig is not the signature of run.json by this key"
        for other in (b"", content[:-1], content + b"\0"):
            path.write_bytes(other)
            assert signature_fault(run, key) == "run.json.sig is not the signature of run.json by this key"
        path.write_bytes(content)
    assert signature_fault(run, key) == ""


def test_another_key_does_not_verify_it(files):
    sign(files / "run.json", ed25519.Ed25519PrivateKey.generate())
    assert "is not the signature" in signature_fault(files / "run.json", public_key(files / "public.pem"))


def test_a_pipe_in_place_of_the_signature_is_reported_and_not_waited_for(files):
    os.mkfifo(files / "run.json.sig")
    fault = signature_fault(files / "run.json", public_key(files / "public.pem"))
    assert fault == "run.json.sig cannot be read: it is no regular file"


def test_a_missing_signature_is_reported(files):
    key = public_key(files / "public.pem")
    assert (
        signature_fault(files / "run.json", key)
        == "run.json is not signed: there is no run.json.sig beside it"
    )
    signature_path(files / "run.json").mkdir()
    assert signature_fault(files / "run.json", key) == "run.json.sig cannot be read: Is a directory"


def no_keys():
    yield "empty", b""
    yield "text", b"hello\n"
    yield "binary", bytes(range(256))
    yield "long", b"x" * 100_000
    yield "torn", pem(ed25519.Ed25519PrivateKey.generate())[:60]
    yield "other curve", pem(ec.generate_private_key(ec.SECP256R1()))
    yield "other public", public_pem(ed448.Ed448PrivateKey.generate())
    yield (
        "password",
        pem(ed25519.Ed25519PrivateKey.generate(), serialization.BestAvailableEncryption(b"secret")),
    )


@pytest.mark.parametrize(("name", "content"), list(no_keys()), ids=[name for name, _ in no_keys()])
def test_a_file_that_is_no_key_is_one_sentence(name, content, tmp_path):
    path = tmp_path / "key.pem"
    path.write_bytes(content)
    with pytest.raises(
        HarnessError, match=r"--sign .*key\.pem: no private Ed25519 key in PEM, without password"
    ):
        private_key(path)
    with pytest.raises(HarnessError, match=r"--verify .*key\.pem: no public Ed25519 key in PEM"):
        public_key(path)


def test_a_key_is_not_taken_for_its_other_half(files):
    with pytest.raises(HarnessError, match="no private"):
        private_key(files / "public.pem")
    with pytest.raises(HarnessError, match="no public"):
        public_key(files / "key.pem")


def test_a_missing_key_is_reported(tmp_path):
    for read in (private_key, public_key):
        with pytest.raises(HarnessError, match=r"none\.pem: cannot be read: No such file"):
            read(tmp_path / "none.pem")
        with pytest.raises(HarnessError, match="cannot be read: Is a directory"):
            read(tmp_path)


def test_without_the_package_the_message_gives_the_extra(files, monkeypatch):
    monkeypatch.setitem(sys.modules, "cryptography", None)
    for read, option in ((private_key, "--sign"), (public_key, "--verify")):
        with pytest.raises(
            HarnessError, match=rf"{option} needs .*: pip install 'torquer\[sign\]'"
        ) as caught:
            read(files / "key.pem")
        assert caught.value.exit_code == 2


@pytest.mark.skipif(shutil.which("openssl") is None, reason="there is no openssl here")
def test_openssl_makes_the_key_and_verifies_the_signature(files):
    def openssl(*words):
        return subprocess.run(["openssl", *words], cwd=files, capture_output=True, text=True, check=False)

    assert openssl("genpkey", "-algorithm", "ed25519", "-out", "key.pem").returncode == 0
    assert openssl("pkey", "-in", "key.pem", "-pubout", "-out", "public.pem").returncode == 0
    sign(files / "run.json", private_key(files / "key.pem"))
    assert signature_fault(files / "run.json", public_key(files / "public.pem")) == ""
    words = ("-pubin", "-inkey", "public.pem", "-rawin", "-in", "run.json", "-sigfile", "run.json.sig")
    done = openssl("pkeyutl", "-verify", *words)
    if "rawin" in done.stderr:
        pytest.skip("this openssl is too old for Ed25519 from its command line")
    assert done.returncode == 0, done.stderr


def test_a_signature_is_replaced_as_a_whole(files, monkeypatch):
    replaced = []
    monkeypatch.setattr(signature, "replace_file", lambda path, content: replaced.append((path, content)))
    sign(files / "run.json", private_key(files / "key.pem"))
    assert [path for path, _ in replaced] == [files / "run.json.sig"]
