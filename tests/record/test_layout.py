"""Everything that the layout shows is in the log, under that name and with that field."""

from __future__ import annotations

import json
import re

import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader

from gaitforge.record.layout import layout, write_layout


@pytest.fixture(scope="module")
def panels(dodecapod, verdict):
    return layout(dodecapod, verdict.timeline)["configById"]


@pytest.fixture(scope="module")
def fields(log_path):
    """Topic → schema name, and the dotted names of all fields, lists marked by []."""
    with log_path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    found = {}
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        names = _json_fields(json.loads(schema.data)) if schema.encoding == "jsonschema" else _protobuf_fields(schema)
        found[channel.topic] = (schema.name, names)
    return found


def _json_fields(schema, prefix=""):
    names = set()
    for key, value in schema["properties"].items():
        here = f"{prefix}{key}" + ("[]" if value["type"] == "array" else "")
        names.add(here)
        inner = value["items"] if value["type"] == "array" else value
        if inner["type"] == "object":
            names |= _json_fields(inner, f"{here}.")
    return names


def _protobuf_fields(schema):
    messages = {}
    for file in FileDescriptorSet.FromString(schema.data).file:
        for message in file.message_type:
            messages[f".{file.package}.{message.name}"] = message

    def walk(name, prefix=""):
        for field in messages[name].field:
            here = f"{prefix}{field.name}" + ("[]" if field.label == field.LABEL_REPEATED else "")
            yield here
            if field.type_name in messages and field.type_name != name:
                yield from walk(field.type_name, f"{here}.")

    return set(walk(f".{schema.name}"))


def _paths(panels):
    for name, panel in panels.items():
        for path in panel.get("paths", []):
            yield name, path["value"]
        for key in ("path", "topicPath", "topicToRender"):
            if panel.get(key):
                yield name, panel[key]


def test_every_message_path_of_every_panel_exists(panels, fields, dodecapod):
    checked = 0
    for panel, path in _paths(panels):
        if re.fullmatch(r"-?[\d.]+", path):
            continue
        match = re.fullmatch(r'(/[\w/]+)((?:\.\w+(?:\[:\]\{name=="[^"]+"\})?)*)', path)
        assert match, f"{panel}: {path}"
        topic, rest = match.groups()
        assert topic in fields, f"{panel}: {path}"
        dotted = re.sub(r"\[:\]\{[^}]*\}", "[]", rest).lstrip(".")
        if dotted:
            assert {dotted, f"{dotted}[]"} & fields[topic][1], f"{panel}: {path}"
        for named in re.findall(r'name=="([^"]+)"', rest):
            assert named in (*dodecapod.joint_names, *dodecapod.limb_names)
        checked += 1
    assert checked > 30


def test_every_topic_that_is_drawn_exists(panels, fields):
    view = panels["3D!main"]
    assert set(view["topics"]) <= set(fields)
    for layer in view["layers"].values():
        if layer["layerId"] == "foxglove.Urdf":
            assert fields[layer["topic"]][0] == "std_msgs/String"
    mode = panels["Image!matrix"]["imageMode"]
    assert fields[mode["imageTopic"]][0] == "foxglove.CompressedImage"
    assert {fields[t][0] for t in mode["annotations"]} == {"foxglove.ImageAnnotations"}


def test_the_ghosts_frame_prefix_and_the_followed_frame_are_those_of_the_transforms(panels, log):
    view = panels["3D!main"]
    (_, solid), (_, plan) = next(log.messages("/tf")), next(log.messages("/plan/tf"))
    assert view["followTf"] in {t.child_frame_id for t in solid.transforms}
    assert view["layers"]["grid"]["frameId"] in {t.parent_frame_id for t in solid.transforms}
    prefixes = {layer["topic"]: layer["framePrefix"] for layer in view["layers"].values() if "topic" in layer}
    names = {prefixes["/plan/robot_description"] + t.child_frame_id for t in solid.transforms}
    assert names == {t.child_frame_id for t in plan.transforms}


def test_every_indicator_has_a_colour_for_every_value_that_occurs(panels, log):
    rules = {name: {r["rawValue"] for r in p["rules"]} for name, p in panels.items() if "rules" in p}
    assert {m["phase"] for _, m in log.messages("/state")} <= rules["Indicator!phase"]
    assert log.report["verdict"] in rules["Indicator!verdict"]


def test_every_panel_is_placed_once_and_every_place_has_a_panel(dodecapod, verdict):
    for images in (False, True):
        made = layout(dodecapod, verdict.timeline, images=images)
        placed = []

        def collect(node, placed=placed):
            if isinstance(node, str):
                placed.append(node)
            else:
                collect(node["first"])
                collect(node["second"])

        for tab in made["configById"][made["layout"]]["tabs"]:
            collect(tab["layout"])
        assert sorted(placed) == sorted(set(made["configById"]) - {made["layout"]})


def test_the_joint_plot_shows_the_limb_whose_job_changes(panels, verdict, dodecapod):
    limb = dodecapod.limb(verdict.timeline.aims[0].limb)
    shown = {re.search(r'"([^"]+)"', p["value"])[1] for p in panels["Plot!joints"]["paths"]}
    assert shown == set(limb.joints)


def test_the_layout_file_is_the_layout(tmp_path, dodecapod, verdict):
    write_layout(tmp_path / "run.layout.json", dodecapod, verdict.timeline)
    assert json.loads((tmp_path / "run.layout.json").read_text()) == layout(dodecapod, verdict.timeline)
