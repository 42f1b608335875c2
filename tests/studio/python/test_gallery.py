"""The gallery: the report of each shipped study says what the commands say that a person types for the same number."""
import html
import json
import math
import re
import shutil

import pytest

from conftest import SOURCE, Program

STUDIES = sorted(path.parent.name for path in (SOURCE / "cases").glob("*/study.toml"))


class Page:
    """A report: its tables under the heading above each, its key figures, its text."""

    def __init__(self, path):
        # What is embedded (pictures) is no text.
        page = re.sub(r'"data:[^"]*"', '""', path.read_text())
        plain = lambda part: html.unescape(re.sub("<.*?>", "", part)).strip()  # noqa: E731
        self.tables, heading = {}, ""
        for match in re.finditer(r"<h[23][^>]*>(?P<heading>.*?)</h[23]>|<table.*?</table>", page, re.S):
            if match["heading"] is not None:
                heading = plain(match["heading"])
                continue
            rows = [[plain(cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.S)]
                    for row in re.findall(r"<tr[^>]*>(.*?)</tr>", match[0], re.S)]
            self.tables.setdefault(heading, []).append([dict(zip(rows[0], row)) for row in rows[1:]])
        self.facts = {plain(label): plain(value) for value, label in re.findall(
            r'<span class="value">(.*?)</span><span class="label">(.*?)</span>', page, re.S)}
        self.text = plain(page)


def shows(cell, value, digits):
    """Is the cell that number, rounded to so many digits?"""
    if value == 0 or abs(value) < 1e-12:
        return abs(float(cell)) < 1e-9
    half = 0.5 * 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    return abs(float(cell) - value) <= half * (1 + 1e-6)


def percentage(cell, fraction):
    """'3.25 %' of three digits."""
    return shows(cell.removesuffix("%").strip(), 100 * fraction, 3)


def test_a_cell_is_the_number_or_not():
    assert shows("2.83", 2.832575, 3) and not shows("2.83", 2.8352, 3) and not shows("2.84", 2.832575, 3)
    assert shows("0", 0.0, 3) and not shows("0.1", 0.0, 3)


@pytest.fixture(scope="module")
def evie(tmp_path_factory):
    """(program in a copy of the study, its report, the JSON of the run)"""
    folder = tmp_path_factory.mktemp("gallery") / "evie"
    shutil.copytree(SOURCE / "cases" / "evie", folder, ignore=shutil.ignore_patterns(".underbody"))
    program = Program(folder)
    run = program.json("study", "run", ".", "--report", "out/index.html", "--no-pictures")
    assert run["failed"] == 0
    return program, Page(folder / "out" / "index.html"), run["results"]


def test_bodies(evie):
    program, page, _ = evie
    shapes = {"ellipse_front with a 2 mm protrusion": "ellipse_front_bump2"}
    (rows,) = page.tables["The body"]
    assert len(rows) == 4
    for row in rows:
        body = program.json("body", f"shapes/{shapes.get(row['body'], row['body'])}.toml")
        assert shows(row["volume (L)"], 1e3 * body["volume"], 4)
        assert shows(row["surface (cm²)"], 1e4 * body["area"], 4)
        assert shows(row["buoyancy (N)"], body["buoyancy"], 4)


def test_loads_of_all_cases(evie):
    program, page, _ = evie
    (rows,) = page.tables["Loads of all cases"]
    assert len(rows) == len(list((program.folder / "fields").glob("*.csv"))) == 48
    assert page.facts["CFD cases"] == "48"
    batches = [program.json("loads", f"fields/{{variant}}-h{{gap:mm}}-p{{pitch:deg}}{ending}.csv", "--symmetry", "y")
               for ending in ("", "-u{speed:m/s}", "-coarse", "-fine")]
    alone = [one for batch in batches for one in batch.get("files", [batch])]  # of one file there is no list
    loads = {one["file"].rsplit("/", 1)[-1].removesuffix(".csv"): one for one in alone}
    for row in rows:
        one = loads[row["case"]]
        assert shows(row["lift (N)"], one["lift_force"], 4), row["case"]
        assert shows(row["drag (N)"], one["drag_force"], 4), row["case"]
        assert shows(row["pitch moment (mN m)"], 1e3 * one["pitch_moment"], 4), row["case"]


@pytest.fixture(scope="module")
def loads_with_errors(evie):
    """A table of loads by the command, and in each row the error that the study takes from its mesh study."""
    program, _, results = evie
    program.json("loads", "fields/{variant}-h{gap:mm}-p{pitch:deg}.csv", "--symmetry", "y", "--out", "loads.csv")
    head, *rows = [line for line in (program.folder / "loads.csv").read_text().splitlines() if not line.startswith("#")]
    sigma = results["mesh/5 mm"]["quantities"]["lift_force"]["standard_uncertainty"]
    (program.folder / "with-errors.csv").write_text(
        "\n".join([f"{head}, lift_force_sigma [N]", *(f"{row}, {sigma!r}" for row in rows)]) + "\n")
    return "with-errors.csv"


@pytest.mark.parametrize("table, variant, weight", [("lift", "ellipse", 0.3), ("lift, elliptic front", "ellipse_front", 0.08)])
def test_equilibria_and_the_film(evie, loads_with_errors, table, variant, weight):
    program, page, results = evie
    found = program.json("table", "equilibria", loads_with_errors, "--where", f"variant={variant},pitch=0", "--axes", "gap",
                         "--quantity", "lift_force", "--weight", weight, "--mass", 3.954)["equilibria"]
    rows = page.tables[table][0]
    assert len(rows) == len(found) >= 2
    for row, one in zip(rows, found):
        assert shows(row["gap (mm)"], 1e3 * one["gap"], 3)
        assert shows(row["± (mm)"], 1e3 * one["sigma"], 2)
        assert row["kind"] == one["stability"]
        assert shows(row["stiffness (N/m)"], one["stiffness"], 3)
        if one["stable"]:
            assert shows(row["frequency (Hz)"], one["frequency"], 3)
            assert shows(row["largest kick survived (mm/s)"], 1e3 * one["kick_velocity"], 3)
        if one["probability"] < 0.995:
            assert shows(row["exists with probability"], one["probability"], 2)
    doubt = lambda one: f" (with probability {one['probability']:.2g})" if one["probability"] < 0.995 else ""
    stable = [f"{1e3 * one['gap']:.2g}\u00a0mm{doubt(one)}" for one in found if one["stable"]]
    assert page.facts[f"stable gaps by '{table}' at a net weight of {weight:g} N"] == ", ".join(stable)
    if table == "lift":
        base = results["body/ellipse"]["elliptic_base"]
        (film,) = page.tables[table][1]
        theory = program.json("theory", "squeeze", f"half_length={base['half_length']},half_width={base['half_width']},"
                              f"gap={found[0]['gap']},density=998")["values"]
        assert shows(film["squeeze damping (N s/m)"], theory["damping"], 3)
        assert shows(film["added mass of the film (kg)"], theory["added_mass"], 3)


def test_the_map(evie):
    program, page, _ = evie
    region = program.json("region", "out/models/glide/model.toml", "--axes", "gap=1mm:100mm,heave_velocity=-0.02:0.02",
                          "--for", "60 s", "--grid", "400x400")
    rows = page.tables["Where it comes back from"][0]
    ends = {one["name"]: one["fraction"] for one in region["classes"]}
    assert {row["end of the motion"] for row in rows} == set(ends) and len(ends) == 4
    for row in rows:
        assert percentage(row["share of the starts"], ends[row["end of the motion"]])


def test_what_the_model_lacks(evie):
    program, page, _ = evie
    found = program.json("discover", "heave/model.toml", "--data", "heave", "--out", "found")
    effects, errors = page.tables["heave test"]
    assert [row["effect the model lacks"] for row in effects] == [one["name"] for one in found["effects"]]
    for row, one in zip(effects, found["effects"]):
        said = dict(re.findall(r"(\w+) = ([-\d.e]+) ±", row["parameters"]))
        assert set(said) == set(one["parameters"])
        assert all(shows(said[name], value["value"], 3) for name, value in one["parameters"].items())
    for row, when in zip(errors, ("before", "after")):
        assert shows(row["error"], 1e3 * found["error"][when]["rmse"], 3)
    assert page.facts["missing in the model of 'heave test'"] == found["effects"][0]["name"].replace("_", " ")


def test_mesh_errors_and_the_solvers_own_forces(evie):
    program, page, results = evie
    # No more than the largest difference, of which a part may be the swing of the run itself.
    for name, quantities in (("forces", ("lift_force", "drag_force")), ("pitch moments of the ellipse", ("pitch_moment",))):
        rows = results[f"verify/{name}"]["rows"]
        assert {row["quantity"] for row in rows} == set(quantities)
        said = float(page.facts[f"largest difference from the solver's own {name}"].removesuffix("%"))
        assert 0 < said <= 100.5 * max(row["error"] for row in rows) and said < 1
    meshes = [row for rows in page.tables["How far to trust the numbers"] for row in rows]
    assert len(meshes) == 6
    for row in meshes:
        one = results[f"mesh/{row['cases']}"]["quantities"][row["quantity"]]
        assert row["convergence"] == one["verdict"]
        assert shows(row["standard uncertainty"], one["standard_uncertainty"], 2)
        gap, key = row["cases"].split()[0], row["quantity"]
        for cell, ending in zip(row["coarse to fine"].split(", "), ("-coarse", "", "-fine")):
            alone = program.json("loads", f"fields/ellipse-h{gap}-p0{ending}.csv", "--symmetry", "y")
            assert shows(cell, alone[key], 3)


@pytest.mark.parametrize("name", [name for name in STUDIES if name.startswith("thesis")])
def test_the_thesis_claim_by_claim(name, tmp_path):
    """Computed by one command alone, that of the study: the page has every statement, its number and its verdict."""
    shutil.copytree(SOURCE / "cases" / name, tmp_path / name, ignore=shutil.ignore_patterns(".underbody"))
    program = Program(tmp_path)
    run = program.json("study", "run", name, "--report", "index.html")
    (result,) = run["results"].values()
    page = Page(tmp_path / "index.html")
    (rows,) = page.tables["The thesis, claim by claim"]
    assert len(rows) == len(result["claims"]) >= 10
    verdicts = {}
    for row, claim in zip(rows, result["claims"]):
        assert (row["where"], row["the thesis says"], row["we compute"], row["verdict"]) == (
            claim["where"], claim["statement"], claim["computed"], claim["verdict"])
        verdicts[claim["verdict"]] = verdicts.get(claim["verdict"], 0) + 1
    for verdict, count in verdicts.items():
        assert page.facts[f"claims: {verdict}"] == str(count)


def test_the_search(tmp_path):
    shutil.copytree(SOURCE / "cases" / "evie-pitch", tmp_path / "evie-pitch", ignore=shutil.ignore_patterns(".underbody"))
    program = Program(tmp_path)
    # Without what is sought: to seek it takes half a minute, and tests/cases/test_design.cpp does so.
    study = tmp_path / "evie-pitch" / "study.toml"
    text = study.read_text()
    study.write_text(re.sub(r"^\[\[design\.(?:objective|limit)\]\].*?(?=^\[|\Z)", "", text, flags=re.M | re.S))
    assert "[[design.fidelity]]" in study.read_text() and "objective" not in study.read_text()
    assert program.run("design", "report", "evie-pitch", "--out", "index.html").returncode == 0
    page = Page(tmp_path / "index.html")
    fitted = {one["quantity"]: one for one in program.json("design", "fit", "evie-pitch")["surrogates"]}
    (rows,) = page.tables["Surrogates"]
    assert {row["quantity"] for row in rows} == set(fitted) and len(rows) == 4
    for row in rows:
        one = fitted[row["quantity"]]
        assert row["runs"] == str(one["left_out"]["points"])
        assert shows(row["error on shapes left out"].split()[0], one["left_out"]["root_mean_square"], 3)
        assert shows(row["error of the nearest shape"].split()[0], one["left_out"]["nearest_shape"], 3)
        assert percentage(row["inside the 95 % band"], one["left_out"]["inside_95"])
        assert shows(row["error scaled by"], one["error_factor"], 3)
    (plan,) = page.tables["Plan"]
    typed = (SOURCE / "cases" / "evie-pitch" / "design" / "plan.csv").read_text().splitlines()
    assert len(plan) == sum(1 for line in typed[1:] if line and not line.startswith("#"))
    program.json("study", "run", "evie-pitch", "--report", "study.html")
    assert "underbody design report STUDY" in Page(tmp_path / "study.html").text


def test_each_study_has_its_page():
    page = (SOURCE / "docs" / "gallery.md").read_text()
    assert STUDIES and all(f"`cases/{name}`" in page and f"gallery/{name}/index.html" in page for name in STUDIES)
    tested = {"evie", "evie-pitch", "thesis", "thesis-dynamics"}
    assert set(STUDIES) == tested, "a study that ships has its numbers tested here"
