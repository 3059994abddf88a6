"""Files of many formats whose distances are known, read by the program, the C library and the
Python package.

Each was once misread or refused without advice. `inputs/` holds the files.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("HAUSBENCH_PROGRAM", ROOT / "build" / "release" / "hausbench")).parent
INPUTS = Path(__file__).resolve().parent / "inputs"


@dataclass
class Known:
    """H(A,B), or h(A,B) if `directed`; `refused`: words of the message that refuses A, instead."""

    a: str
    b: str
    distance: float = 0.0
    directed: bool = False
    options: dict[str, str] = field(default_factory=dict)
    rounding: float = 0.0  # of the float32 numbers of a file
    refused: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "-".join([self.a, *(f"{name}={value}" for name, value in self.options.items())])


BOX = "02_box.off"
KNOWN = [
    Known("03_modelnet.off", BOX),
    Known("06_inch.3mf", "06_box_25.4.stl", options={"unit": "mm"}, rounding=1e-6),
    Known("30_inch.amf", "06_box_25.4.stl", options={"unit": "mm"}, rounding=1e-6),
    Known("06_inch.3mf", "06_box_25.4.stl", 24.4 * 3**0.5, rounding=1e-6),
    Known("30_inch.amf", "06_box_25.4.stl", 24.4 * 3**0.5, rounding=1e-6),
    Known("07_quant_u16.glb", "07_box_2_at_1.off"),
    Known("07_quant_i16_norm.glb", "07_box_2_at_1.off"),
    Known("07_float.glb", "07_box_2_at_1.off"),
    Known("08_zup_m.dae", "08_box123.stl"),
    Known("08_xup_m.dae", "08_box123.stl"),
    Known("08_yup_inch.dae", "08_box123.stl"),
    Known("32_block.dxf", "32_squares.off"),
    Known("09_id_first.csv", "09_ref.xyz"),
    Known("09_label_hash.csv", "09_ref.xyz"),
    Known("36_pnezd.csv", "36_ref.xyz", refused=("36_pnezd.csv", "5 columns", "2,3,4")),
    Known("36_pnezd.csv", "36_ref.xyz", options={"columns": "2,3,4"}),
    Known("25_cloud.txt", "09_ref.xyz"),
    Known("25_cloud.asc", "09_ref.xyz"),
    Known("25_cloud.xyzn", "09_ref.xyz"),
    Known("25_cloud.xyzrgb", "09_ref.xyz"),
    Known(
        "10_organized.pcd",
        "10_plane.xyz",
        refused=("10_organized.pcd", "line ", "not finite", "--drop-invalid", "drop_invalid"),
    ),
    Known("10_organized.pcd", "10_plane.xyz", 1, directed=True, options={"drop_invalid": "yes"}),
    Known("27_nan_unused.ply", "27_tri.off", directed=True),
    Known("27_nan_unused_bin.ply", "27_tri.off", directed=True),
    Known("18_point.xyz", "18_polyline.obj", 1, directed=True),
    Known("18_point.xyz", "18_edges.ply", 1, directed=True),
    Known("18_point2.xyz", "18_mesh_and_line.obj", 1, directed=True),
    Known("34_surf.obj", "34_point.xyz", refused=("34_surf.obj", "line ", "convert")),
    *(
        Known(f"19_box{kind}", BOX)
        for kind in (".vtk", "_poly.vtk", ".vtp", ".vtu", ".mesh", ".msh")
    ),
    Known("20_points.glb", "20_points.xyz"),
    Known("22_production_two.3mf", "22_two.off"),
    Known("22_production.3mf", "22_two.off", 2),  # its one part stands at x from 2 to 3
    Known(
        "29_morph.glb", BOX, 3**0.5
    ),  # the default weight moves a corner from (1, 1, 1) to (2, 2, 2)
    Known("29_unknown_required.glb", BOX, refused=("29_unknown_required.glb", "ACME")),
]
UNREAD = [
    ("scan.las", "LAS", "las2txt"),
    ("scan.laz", "LAZ", "las2txt"),
    ("scan.e57", "E57", "pdal"),
    ("mask.nii.gz", "voxels", "marching_cubes"),
    ("mask.nrrd", "voxels", "marching_cubes"),
    ("part.step", "STEP", "STL"),
    ("part.igs", "IGES", "STL"),
    ("photo.png", "picture", "mesh"),
    ("all.zip", "ZIP", "unpack"),
    ("scene.x3d", "X3D", "convert"),
]

PYTHON = """\
import json, sys, hausbench
a, b, directed, options = sys.argv[1], sys.argv[2], sys.argv[3] == "1", json.loads(sys.argv[4])
if "drop_invalid" in options: options["drop_invalid"] = True
try:
    shapes = [hausbench.read(a, **options)]
    options.pop("columns", None)  # of A
    shapes.append(hausbench.read(b, **options))
    interval = (hausbench.directed if directed else hausbench.symmetric)(*shapes).interval
except hausbench.InputError as error:
    sys.exit(str(error))
print(repr(interval.lower), repr(interval.upper))
"""

C = """\
#include <hausbench.h>
#include <stdio.h>
#include <string.h>

static hausbench_shape* shape_of(const char* path, char** given) {
    hausbench_read_options options = HAUSBENCH_READ_OPTIONS_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_shape* shape = NULL;
    if (*given[0]) options.columns = given[0];
    if (*given[1]) options.unit = given[1];
    options.drop_invalid = *given[2] != 0;
    if (hausbench_read_with(path, &options, &shape, &error) != HAUSBENCH_OK) fprintf(stderr, "%s\\n", error.text);
    return shape;
}

int main(int count, char** given) {
    hausbench_query query = HAUSBENCH_QUERY_INIT;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_pair* pair = NULL;
    hausbench_shape *a, *b;
    int code;
    if (count != 7 || !(a = shape_of(given[1], given + 4))) return 2;
    *given[4] = 0; /* the columns are those of A */
    if (!(b = shape_of(given[2], given + 4))) return 2;
    code = hausbench_prepare(a, b, NULL, &pair, &error);
    if (code == HAUSBENCH_OK)
        code = *given[3] == '1' ? hausbench_directed(pair, &query, &answer, &error) : hausbench_symmetric(pair, &query, &answer, &error);
    if (code != HAUSBENCH_OK) fprintf(stderr, "%s\\n", error.text);
    else printf("%.17g %.17g\\n", answer.bounds.lower, answer.bounds.upper);
    hausbench_pair_release(pair);
    hausbench_shape_release(a);
    hausbench_shape_release(b);
    return code == HAUSBENCH_OK ? 0 : 2;
}
"""


@pytest.fixture(scope="session")
def c_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("c")
    (folder / "read.c").write_text(C)
    subprocess.run(
        [
            "cc",
            "-std=c99",
            "-Wall",
            "-Werror",
            folder / "read.c",
            f"-I{ROOT / 'library'}",
            f"-L{BUILD / 'library'}",
            "-lhausbench",
            f"-Wl,-rpath,{BUILD / 'library'}",
            "-o",
            folder / "read",
        ],
        check=True,
    )
    return folder / "read"


def run(words: list[str | Path]) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(BUILD / "python"), "HAUSBENCH_ROOT": str(ROOT)}
    return subprocess.run(
        list(map(str, words)),
        capture_output=True,
        text=True,
        timeout=120,
        cwd=INPUTS,
        env=environment,
    )


def by_program(pair: Known) -> subprocess.CompletedProcess[str]:
    options = [
        f"--{name.replace('_', '-')}" + ("" if value == "yes" else f"={value}")
        for name, value in pair.options.items()
    ]
    done = run(
        [
            BUILD / "hausbench",
            "measure",
            pair.a,
            pair.b,
            "--json",
            *([] if pair.directed else ["--symmetric"]),
            *options,
        ]
    )
    if done.returncode == 0:
        answer = json.loads(done.stdout)
        done.stdout = f"{answer['lower']!r} {answer['upper']!r}"
    else:
        assert done.returncode == 2
    return done


def by_c(pair: Known, program: Path) -> subprocess.CompletedProcess[str]:
    return run(
        [
            program,
            pair.a,
            pair.b,
            str(int(pair.directed)),
            *(pair.options.get(name, "") for name in ("columns", "unit", "drop_invalid")),
        ]
    )


def by_python(pair: Known) -> subprocess.CompletedProcess[str]:
    return run(
        [
            sys.executable,
            "-c",
            PYTHON,
            pair.a,
            pair.b,
            str(int(pair.directed)),
            json.dumps(pair.options),
        ]
    )


def check(pair: Known, done: subprocess.CompletedProcess[str]) -> None:
    if pair.refused:
        assert done.returncode != 0, done.stdout
        message = done.stderr.strip()
        assert "\n" not in message and all(word in message for word in pair.refused), message
        return
    assert done.returncode == 0, done.stderr
    lower, upper = map(float, done.stdout.split())
    slack = pair.rounding + 1e-14
    assert lower - slack <= pair.distance <= upper + slack and upper - lower < 1e-4, (lower, upper)


@pytest.mark.parametrize("pair", KNOWN, ids=str)
def test_the_program_reads_it_right(pair: Known) -> None:
    check(pair, by_program(pair))


@pytest.mark.parametrize("pair", KNOWN, ids=str)
def test_the_c_library_reads_it_right(pair: Known, c_program: Path) -> None:
    check(pair, by_c(pair, c_program))


@pytest.mark.parametrize("pair", KNOWN, ids=str)
def test_python_reads_it_right(pair: Known) -> None:
    check(pair, by_python(pair))


@pytest.mark.parametrize("name, kind, advice", UNREAD)
def test_what_is_not_read_is_named_with_advice(
    tmp_path: Path, c_program: Path, name: str, kind: str, advice: str
) -> None:
    file = tmp_path / name
    file.write_bytes(b"not what the name says")
    pair = Known(str(file), BOX, refused=(name, kind, advice))
    for done in (by_program(pair), by_c(pair, c_program), by_python(pair)):
        check(pair, done)


def test_a_kind_is_told_by_its_first_bytes_whatever_the_name_says(tmp_path: Path) -> None:
    for name, begin, kind in [
        ("a.obj", b"ISO-10303-21;\n", "STEP"),
        ("a.stl", b"PK\x03\x04 and more", "ZIP"),
        ("a.xyz", b"LASF\x00", "LAS"),
        ("a.ply", b"\x89PNG\r\n", "picture"),
    ]:
        file = tmp_path / name
        file.write_bytes(begin)
        pair = Known(str(file), BOX, refused=(name, kind))
        check(pair, by_program(pair))


def test_both_units_stated_and_different_are_refused_by_all(c_program: Path) -> None:
    pair = Known("06_inch.3mf", "07_float.glb", refused=("06_inch.3mf", "inch", "unit", "none"))
    for done in (by_program(pair), by_c(pair, c_program), by_python(pair)):
        check(pair, done)


def test_the_page_about_formats_agrees_with_the_program() -> None:
    done = run([sys.executable, ROOT / "tools" / "formats", "--check"])
    assert done.returncode == 0, done.stderr
