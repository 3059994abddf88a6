"""`measure --certificate` writes a proof of the upper bound, and `verify --certificate` checks it.

Malformed proofs are written here, following docs/certificate.md alone.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from program import Program

File = tuple[dict[str, Any], bytes]


def read(file: Path) -> File:
    content, seal = file.read_bytes().rsplit(b"\nsha256 ", 1)
    assert seal.decode() == hashlib.sha256(content).hexdigest() + "\n"
    line, rest = content.split(b"\n", 1)
    return json.loads(line), rest


def write(file: Path, content: File) -> Path:
    return sealed(file, json.dumps(content[0]).encode() + b"\n" + content[1])


def sealed(file: Path, content: bytes) -> Path:
    file.write_bytes(content + f"\nsha256 {hashlib.sha256(content).hexdigest()}\n".encode())
    return file


def number(value: int) -> bytes:
    out = b""
    while value >= 0x80:
        out += bytes([value & 0x7F | 0x80])
        value >>= 7
    return out + bytes([value])


def leaf(k: int) -> bytes:
    return number(k << 2 | 1)


def cut(edge: int, t: float, corner: int) -> bytes:
    """Returns a cut from the point at parameter t of an edge to a corner."""
    return number((edge << 2 | (corner << 2 | 1) << 8) << 2) + struct.pack("<d", t)


@pytest.fixture
def proof(
    hausbench: Program, plugin: Path, tetrahedron: Path, raised: Path, tmp_path: Path
) -> Path:
    file = tmp_path / "proof"
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "vertex_only",
        "--plugin",
        plugin,
        "--certificate",
        file,
    )
    assert done.returncode == 0, done.stderr
    assert f"proof      {file}: at most 0.25" in done.stdout
    return file


def test_a_proof_is_written_and_accepted(
    hausbench: Program, proof: Path, tetrahedron: Path, raised: Path
) -> None:
    done = hausbench("verify", "--certificate", proof)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = {line[:11].strip(): line[11:] for line in done.stdout.splitlines() if line[0] != " "}
    assert list(lines) == ["answer", "h(A,B)", "lower", "accepted"]
    assert lines["lower"].endswith("holds, by its witness")
    assert lines["accepted"].startswith("the distance is at most 0.25")
    assert "0 cuts, 4 leaves (one 4, centre 0, vertex 0)" in done.stdout
    header, _ = read(proof)
    assert header["source"]["file"] == str(tetrahedron) and header["quantity"] == "directed"
    assert 0.25 <= header["certificates"][0]["proven"] <= 0.25 + 1e-13

    # The file of A was moved, so verify must be given both names.
    moved = tetrahedron.rename(tetrahedron.with_name("moved.off"))
    assert (
        "moved.off" not in (line := hausbench.fails("verify", "--certificate", proof))
        and "name A and B" in line
    )
    assert hausbench("verify", "--certificate", proof, moved, raised).returncode == 0
    assert "is not the shape" in hausbench.fails("verify", "--certificate", proof, raised, moved)


def test_both_directions(
    hausbench: Program, plugin: Path, tetrahedron: Path, tmp_path: Path
) -> None:
    spike = tmp_path / "spike.off"
    spike.write_text(tetrahedron.read_text().replace("0 0 1\n3", "0 0 3\n3", 1))
    for of in ("diagonal", "lower"):
        file = tmp_path / "both"
        options = ("--symmetric", "--tolerance", "0.5", "--of", of)
        done = hausbench(
            "measure",
            tetrahedron,
            spike,
            "--solver",
            "vertex_only",
            "--plugin",
            plugin,
            "--json",
            *options,
            "--certificate",
            file,
        )
        assert done.returncode == 0, done.stderr
        header, _ = read(file)
        assert [c["direction"] for c in header["certificates"]] == [
            "source to target",
            "target to source",
        ]
        assert (
            json.loads(done.stdout)["proven"]
            == max(c["proven"] for c in header["certificates"])
            >= 2
        )
        done = hausbench("verify", "--certificate", file)
        assert done.returncode == 0, done.stdout
        assert "\nh(A,B) " in done.stdout and "\nh(B,A) " in done.stdout
        # A proof of one direction does not prove H.
        header["certificates"].pop()
        done = hausbench(
            "verify",
            "--certificate",
            write(tmp_path / "half", (header, read(file)[1][: header["certificates"][0]["bytes"]])),
        )
        assert done.returncode == 1 and "refused    H(A,B) takes" in done.stdout


def test_a_proof_written_by_hand(hausbench: Program, proof: Path, tmp_path: Path) -> None:
    """B is A raised by 0.25, so each face of A is within 0.25 of a face of B."""
    header, rest = read(proof)
    header["upper"] = 0.25 + 1e-12
    certificate = header["certificates"][0]
    leaves = [leaf(k) for k in range(4)]

    def answer(trees: list[bytes], **changes: Any) -> tuple[int, str]:
        data = b"".join(trees)
        certificate.update({"bytes": len(data), "proven": 0.25 + 1e-12, **changes})
        done = hausbench("verify", "--certificate", write(tmp_path / "mine", (header, data)))
        assert done.stderr == ""
        return done.returncode, done.stdout

    assert rest == b"".join(leaves)
    assert answer(leaves)[0] == 0
    halves = [cut(0, 0.5, 2) + leaves[0] + leaves[0], *leaves[1:]]
    code, said = answer(halves)
    assert code == 0 and "1 cuts, 5 leaves" in said
    # False claims and incomplete proofs are refused.
    code, said = answer([leaves[1], *leaves[1:]])
    assert code == 1 and "refused    triangle 0: its leaves show 1" in said
    assert answer(leaves, proven=0.2499)[0] == 1
    assert "triangle 3, node 0: the certificate ends here" in answer(leaves[:3])[1]
    assert "triangle 3, node 0: the certificate ends here" in answer([cut(0, 0.5, 2), *leaves])[1]
    assert (
        "triangle 4, node 0: there are bytes after the last triangle"
        in answer([*leaves, leaves[0]])[1]
    )
    assert (
        "triangle 2, node 0: a leaf names triangle 4 of 4 in the target"
        in answer([*leaves[:2], leaf(4), leaves[3]])[1]
    )
    assert (
        "a cut is not between the ends of its edge"
        in answer([cut(0, float("nan"), 2), leaves[0], *leaves])[1]
    )
    assert "its format is not" in answer(leaves, format="another")[1]
    # The bound of the answer must be proven.
    code, said = answer(leaves, format="hausbench cover 1", proven=0.26)
    assert code == 1 and "above the upper bound 0.25" in said


def test_the_lower_bound_is_checked_too(hausbench: Program, proof: Path, tmp_path: Path) -> None:
    header, rest = read(proof)

    def answer(**changes: Any) -> tuple[int, str]:
        done = hausbench(
            "verify", "--certificate", write(tmp_path / "mine", ({**header, **changes}, rest))
        )
        return done.returncode, done.stdout

    code, said = answer(lower=0.2500001, upper=0.26)
    assert code == 1 and "refused    lower bound 0.2500001: its witness shows only 0.25" in said
    code, said = answer(lower=0.2500001)
    assert code == 1 and "it is above the upper bound" in said
    assert answer(lower=-1)[0] == answer(lower="nan")[0] == 1
    assert answer(lower=0)[0] == 0
    nowhere = {**header["witness"], "source_point": ["nan", "nan", "nan"]}
    code, said = answer(witness=nowhere)
    assert code == 1 and "it has no witness, so nothing shows it" in said
    assert answer(witness=nowhere, lower=0)[0] == 0
    assert answer(witness={**header["witness"], "direction": "target to source"})[0] == 1


@pytest.mark.parametrize(
    "change",
    [
        "no header",
        "no line",
        "cut short",
        "too long",
        "huge",
        "negative",
        "version",
        "types",
        "quantity",
    ],
)
def test_files_that_are_no_certificates(
    hausbench: Program, proof: Path, tmp_path: Path, change: str
) -> None:
    header, rest = read(proof)
    size = header["certificates"][0]
    bad = tmp_path / "bad"
    if change == "cut short":
        rest = rest[:-1]
    elif change == "too long":
        rest += b"\0"
    elif change == "huge":
        size["bytes"] = 2**63
    elif change == "negative":
        size["bytes"] = -1
    elif change == "version":
        header["hausbench_certificate"] = 1
    elif change == "types":
        header["witness"] = 3
    elif change == "quantity":
        header["quantity"] = "mean"
    write(bad, (header, rest))
    if change == "no header":
        sealed(bad, b"{}\n" + rest)
    elif change == "no line":
        sealed(bad, b"\xff" * 100)
    assert "is not a certificate file" in hausbench.fails("verify", "--certificate", bad)


def test_a_changed_byte_is_damage(hausbench: Program, proof: Path, tmp_path: Path) -> None:
    whole = proof.read_bytes()
    bad = tmp_path / "bad"
    for at in (0, whole.index(b"tolerance"), whole.index(b"\n") + 1, len(whole) - 80):
        bad.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        assert "damaged: its SHA-256 does not match" in hausbench.fails(
            "verify", "--certificate", bad
        )
    for content in (whole[:-1], whole[: whole.rindex(b"\n", 0, -1)], b""):
        bad.write_bytes(content)
        assert "it does not end in its SHA-256" in hausbench.fails("verify", "--certificate", bad)


def test_mistakes(
    hausbench: Program, plugin: Path, proof: Path, tetrahedron: Path, tmp_path: Path
) -> None:
    assert "cannot be read" in hausbench.fails("verify", "--certificate", tmp_path / "missing")
    assert "cannot be read" in hausbench.fails("verify", "--certificate", tmp_path)
    assert "A and B" in hausbench.fails("verify", "--certificate", proof, tetrahedron)
    assert "--certificate" in hausbench.fails("verify", proof, tetrahedron)
    line = hausbench.fails(
        "measure",
        tetrahedron,
        tetrahedron,
        "--solver",
        "tang",
        "--plugin",
        plugin,
        "--certificate",
        tmp_path / "x",
    )
    assert "writes no certificates" in line and "vertex_only" in line
    at = tmp_path / "no folder" / "x"
    assert "folder" in hausbench.fails(
        "measure",
        tetrahedron,
        tetrahedron,
        "--solver",
        "vertex_only",
        "--plugin",
        plugin,
        "--certificate",
        at,
    )
    # If a requested proof cannot be written, the program says so and does not succeed.
    out = tmp_path / "none"
    done = hausbench(
        "measure",
        tetrahedron,
        tetrahedron,
        "--solver",
        "vertex_only",
        "--plugin",
        plugin,
        "--time-limit",
        "0",
        "--certificate",
        out,
    )
    assert done.returncode == 1 and not out.exists()
    assert (
        f"{out} is not written: time was out before each triangle of A had a bound; allow it more time"
        in done.stdout + done.stderr
    )


@pytest.mark.parametrize("solver", ["guthe", "sacht", "kang", "zheng", "cover"])
def test_mesh_solvers_write_proofs(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, solver: str
) -> None:
    for options in ((), ("--symmetric",)):
        file = tmp_path / solver
        done = hausbench(
            "measure", tetrahedron, raised, "--solver", solver, *options, "--certificate", file
        )
        assert done.returncode == 0, done.stdout + done.stderr
        done = hausbench("verify", "--certificate", file)
        assert (
            done.returncode == 0
            and f"answer     of {solver}: " in done.stdout
            and "\naccepted " in done.stdout
        )


@pytest.mark.parametrize("in_process", [False, True])
@pytest.mark.parametrize("how", ["lower above", "false proof", ""])
def test_measure_warns_if_its_own_proof_is_refused(
    hausbench: Program,
    outside: Path,
    tetrahedron: Path,
    raised: Path,
    tmp_path: Path,
    how: str,
    in_process: bool,
) -> None:
    file = tmp_path / "mine"
    deed = ("--set", "at=0", "--set", f"how={how}") if how else ()
    options: tuple[str | Path, ...] = (
        "--json",
        "--solver",
        "lies",
        "--plugin",
        outside / "libmisbehaving.so",
        *deed,
        *(["--in-process"] if in_process else []),
    )
    done = hausbench("measure", tetrahedron, raised, *options, "--certificate", file)
    said = json.loads(done.stdout)
    checked = hausbench("verify", "--certificate", file)
    assert done.returncode == checked.returncode == (1 if how else 0)
    assert len(said["warnings"]) == (1 if how else 0)
    if how:
        why = checked.stdout.splitlines()[-1].removeprefix("refused").strip()
        assert why in said["warnings"][0] and said["warnings"][0].startswith(
            f"{file}: its own check refuses this proof: "
        )


def test_bounds_that_prove_nothing_are_said(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path
) -> None:
    out = tmp_path / "none"
    done = hausbench(
        "measure",
        tetrahedron,
        raised,
        "--solver",
        "guthe",
        "--set",
        "kernel=textbook",
        "--certificate",
        out,
    )
    assert done.returncode == 1 and not out.exists()
    assert "kernel = textbook or certify = false" in done.stdout + done.stderr


def shape_sha256(
    kind: str, vertices: list[tuple[float, ...]], triangles: list[tuple[int, ...]]
) -> str:
    """Computes the hash as described in docs/certificate.md, without the program's code."""
    content = struct.pack("<Q", len(kind)) + kind.encode() + struct.pack("<Q", len(vertices))
    content += b"".join(struct.pack("<3d", *vertex) for vertex in vertices)
    if kind == "mesh":
        content += struct.pack("<Q", len(triangles)) + b"".join(
            struct.pack("<3i", *triangle) for triangle in triangles
        )
    return hashlib.sha256(content).hexdigest()


def test_the_document_says_how_the_sha256_of_a_shape_is_taken(
    hausbench: Program, tmp_path: Path
) -> None:
    # An unused vertex, a -0, a polygon, and a value that single precision cannot hold.
    mesh, points, proof = tmp_path / "a.off", tmp_path / "b.xyz", tmp_path / "proof"
    mesh.write_text(
        "OFF\n6 2 0\n0 0 -0.0\n9 9 9\n1 0 0.1\n1 1 0\n0 1 0\n0 0 1\n4 0 2 3 4\n3 5 2 0\n"
    )
    points.write_text("0 0 0\n1e-320 -2.5 1e300\n")
    vertices: list[tuple[float, ...]] = [(0, 0, -0.0), (1, 0, 0.1), (1, 1, 0), (0, 1, 0), (0, 0, 1)]
    of_mesh = shape_sha256("mesh", vertices, [(0, 1, 2), (0, 2, 3), (4, 1, 0)])
    of_points = shape_sha256("points", [(0, 0, 0), (1e-320, -2.5, 1e300)], [])
    assert (
        hausbench("measure", mesh, points, "--solver", "cover", "--certificate", proof).returncode
        == 0
    )
    header, _ = read(proof)
    assert [header[side]["sha256"] for side in ("source", "target")] == [of_mesh, of_points]


@pytest.mark.parametrize("text", ["inf", "-inf", "nan"])
def test_the_document_says_how_numbers_that_json_lacks_are_written(
    hausbench: Program, tetrahedron: Path, raised: Path, tmp_path: Path, text: str
) -> None:
    file = tmp_path / "proof"
    assert (
        hausbench(
            "measure", tetrahedron, raised, "--solver", "cover", "--certificate", file
        ).returncode
        == 0
    )
    header, rest = read(file)
    header["lower"] = 0
    header["witness"]["source_point"] = header["witness"]["target_point"] = ["nan", "nan", "nan"]
    header["upper"] = text
    done = hausbench("verify", "--certificate", write(file, (header, rest)))
    assert f"in [0, {text}]" in done.stdout, done.stdout + done.stderr
    assert done.returncode == (0 if text == "inf" else 1), done.stdout + done.stderr


def test_pairs_whose_models_are_missing_are_skipped(program_file: str, tmp_path: Path) -> None:
    script, cache = Path(__file__).resolve().parents[1] / "certificates.py", {
        **os.environ,
        "HAUSBENCH_CACHE": str(tmp_path),
    }
    done = subprocess.run(
        [sys.executable, script, "--program", program_file, "--pairs", "2"],
        capture_output=True,
        text=True,
        env=cache,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (
        "skipped: armadillo to armadillo_half: " in done.stdout
        and "run `hausbench fetch`" in done.stdout
    )
    assert "0 of 0 pairs as they should be; 2 skipped" in done.stdout
