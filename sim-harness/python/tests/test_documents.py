"""Docstrings run, stubs say what the module has, pictures are pictures."""

import ast
import doctest
import inspect
import xml.etree.ElementTree as xml
from pathlib import Path

import pytest

import rundown
from conftest import ROOT
from rundown import _rundown

PUBLIC = [name for name in rundown.__all__ if not name.startswith("_")]


@pytest.mark.parametrize("name", ["import_logs", "preview_logs", "replay", "simulate", "check", "gap", "export", "convert"])
def test_the_examples_run(name):
    function = getattr(rundown, name)
    [test] = doctest.DocTestFinder(recurse=False).find(function, name, module=False, globs={})
    assert test.examples, f"{name} has no example"
    failed, tried = doctest.DocTestRunner().run(test)
    assert (failed, tried) == (0, len(test.examples))


@pytest.mark.parametrize("document", ["README.md", "docs/python.md"])
def test_the_lines_of_the_documents_run_again(document, monkeypatch, tmp_path, capsys):
    """In a folder in which they have run before; on 10 runs, as the other tests."""
    text = (ROOT / document).read_text()
    lines = text.split("```python\n")[1].split("```")[0]
    simulate = rundown.simulate
    monkeypatch.setattr(rundown, "simulate", lambda *out, **options: simulate(*out, runs=10, **options))
    monkeypatch.chdir(tmp_path)
    simulate("tunnel", runs=1)
    exec(compile(lines, document, "exec"), {})
    printed = capsys.readouterr().out
    assert "verdict: explained" in printed and "resistance_n_per_kg" in printed and "run010" in printed


def members(node):
    return {one.name: one for one in node.body if isinstance(one, ast.FunctionDef)}


def test_the_stubs_are_those_of_the_module():
    stub = ast.parse(Path(rundown.__file__).with_suffix(".pyi").read_text())
    classes = {one.name: one for one in stub.body if isinstance(one, ast.ClassDef) and not one.name.startswith("_")}
    functions = members(stub)
    assert sorted([*classes, *functions]) == sorted(PUBLIC)
    compared = 0
    for name, node in functions.items():
        compared += agrees(name, node, getattr(rundown, name))
    for name in set(classes) - {"RundownError"}:
        real = {key for key in vars(getattr(rundown, name)) if not key.startswith("__")}
        said = members(classes[name])
        assert real == {key for key in said if not key.startswith("__")}, name
        for key, node in said.items():
            if not any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list):
                if not key.startswith("__"):
                    compared += agrees(f"{name}.{key}", node, getattr(getattr(rundown, name), key))
    assert compared >= 16


def agrees(name, node, real):
    """Names, kinds and defaults of the arguments."""
    said = node.args
    given = inspect.signature(real).parameters.values()
    names = [one.arg for one in [*said.args, *said.kwonlyargs]]
    assert [one.name for one in given] == names, name
    keyword = [one.name for one in given if one.kind is inspect.Parameter.KEYWORD_ONLY]
    assert keyword == [one.arg for one in said.kwonlyargs], name
    defaults = [None] * (len(said.args) - len(said.defaults)) + said.defaults + said.kw_defaults
    for one, default in zip(given, defaults):
        found = inspect.Parameter.empty if default is None else ast.literal_eval(default)
        assert one.default == found, (name, one.name)
    return 1


def test_everything_has_a_docstring():
    for name in PUBLIC:
        thing = getattr(rundown, name)
        assert (thing.__doc__ or "").strip(), name
        if inspect.isclass(thing) and thing is not rundown.RundownError and thing is not rundown.Simulated:
            for key, member in vars(thing).items():
                if not key.startswith("_"):
                    assert (member.__doc__ or "").strip(), f"{name}.{key}"
    assert rundown.__version__ == _rundown.__version__


def paths_of(figure):
    return sum(1 for one in xml.fromstring(figure.svg).iter() if one.tag.rsplit("}")[-1] in ("path", "polyline", "polygon"))


def test_pictures_of_a_replay_are_drawn(reference, tmp_path):
    learned = rundown.replay(**reference)
    for name in ["resistance", "history", "motion", "terms", "regimes", "innovations"]:
        assert paths_of(learned.plot(name)) > 2, name
    learned.plot().save(tmp_path / "r.svg")
    assert (tmp_path / "r.svg").read_text() == learned.plot("resistance")._repr_svg_()
    with pytest.raises(rundown.RundownError, match="expected a name that ends with .svg"):
        learned.plot().save(tmp_path / "r.png")
    assert not (tmp_path / "r.png").exists()
    with pytest.raises(rundown.RundownError, match="what: expected resistance"):
        learned.plot("resistence")


def test_the_tunnel_is_found_and_drawn(tunnel):
    _, found = tunnel
    assert found.verdict == "explained"
    assert "tunnel_drag" in str(found)
    for name in ["residual", "coordinates", "law", "before_after"]:
        assert paths_of(found.plot(name)) > 2, name
    before, after, measured = (found.before_after[name] for name in ["before_kmh", "after_kmh", "measured_kmh"])
    square = lambda simulated: sum((a - b) ** 2 for a, b in zip(simulated, measured))
    assert square(after) < 0.8 * square(before)
