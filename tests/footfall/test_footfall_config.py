"""The config groups of the constraint families say what the classes say, and nothing else."""

from dataclasses import fields
from importlib import import_module
from pathlib import Path

import pytest
import yaml

from gaitforge.footfall.constraints import SupportSectors, default_constraints
from gaitforge.footfall.solvers.cpsat import CpSat

GROUP = Path(__file__).parents[2] / "conf" / "footfall"
OPTIONS = sorted((GROUP / "constraints").glob("*.yaml"))
ON_REQUEST = (SupportSectors(),)
"""Families that a user adds; the others are on by default."""


def built(node):
    module, name = node["_target_"].rsplit(".", 1)
    return getattr(import_module(module), name)(**{k: v for k, v in node.items() if k != "_target_"})


@pytest.mark.parametrize("path", OPTIONS, ids=lambda path: path.stem)
def test_an_option_is_one_family_under_its_key_with_the_defaults_of_its_class(path):
    ((key, node),) = yaml.safe_load(path.read_text()).items()
    family = built(node)
    assert family.key == key
    assert family in (*default_constraints(), *ON_REQUEST)
    assert set(node) == {"_target_", *(f.name for f in fields(family))}
    assert node["_target_"].split(".")[-2] == path.stem, "option file and module share a name"


@pytest.mark.parametrize(
    "path", [*OPTIONS, GROUP / "solver" / "cpsat.yaml", GROUP / "default.yaml"], ids=lambda p: p.stem
)
def test_every_parameter_has_a_comment_with_its_unit(path):
    for line in path.read_text().splitlines():
        key = line.strip().split(":")[0]
        if ":" in line and not line.strip().startswith(("#", "-")) and line.split(":", 1)[1].split("#")[0].strip():
            assert key == "_target_" or "# [" in line, line


def test_the_default_takes_every_family_once_in_order():
    default = yaml.safe_load((GROUP / "default.yaml").read_text())
    listed = next(d["constraints"] for d in default["defaults"] if isinstance(d, dict) and "constraints" in d)
    on_request = {family.key for family in ON_REQUEST}
    assert sorted(listed) == [p.stem for p in OPTIONS if p.stem.split("_")[0] not in on_request]
    keys = [next(iter(yaml.safe_load((GROUP / "constraints" / f"{name}.yaml").read_text()))) for name in listed]
    assert keys == [c.key for c in default_constraints()]


def test_the_solver_option_has_the_defaults_of_its_class():
    assert built(yaml.safe_load((GROUP / "solver" / "cpsat.yaml").read_text())) == CpSat()


def test_hydra_composes_drops_and_changes_families():
    from hydra import compose, initialize_config_dir
    from omegaconf import OmegaConf

    with initialize_config_dir(str(GROUP.parent.resolve()), version_base="1.3"):
        whole = compose(
            overrides=["+footfall=default", "~footfall.constraints.g10", "footfall.constraints.g8.at_least=4"]
        )
        few = compose(overrides=["+footfall=default", "footfall/constraints=[g08_stance_count,gap]"])
    constraints = OmegaConf.to_container(whole.footfall.constraints)
    assert set(constraints) == {c.key for c in default_constraints()} - {"g10"}
    assert built(constraints["g8"]).at_least == 4
    assert set(few.footfall.constraints) == {"g8", "gap"}
