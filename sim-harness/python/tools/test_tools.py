"""Do the tools themselves read what `rundown export` writes, and is the running resistance the same there?

`cargo xtask tools` runs this. It needs the command (RUNDOWN_COMMAND) and the packages of requirements.txt.
"""

import os
import pathlib
import re
import subprocess
import tomllib
import xml.etree.ElementTree

import altrios
import pytest
import yaml

SPEED_MPS = 100 / 3.6
GRAVITY_MPS2 = 9.80665


def run(*arguments, folder):
    """Runs a program that must succeed."""
    done = subprocess.run(arguments, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="session")
def exported(tmp_path_factory):
    """The files of a train that was learned, and the train as Rundown has it."""
    folder = tmp_path_factory.mktemp("exported")
    rundown = os.environ["RUNDOWN_COMMAND"]
    run(rundown, "simulate", "--runs", "3", "--seed", "7", "--out", "set", folder=folder)
    train = "set/train.toml"
    run(rundown, "replay", "--train", train, "--track", "set/track.toml", "set/runs", folder=folder)
    arguments = ["--train", train, "--traction", "1500V", "--max-speed", "140"]
    run(rundown, "export", "--to", "sumo,sumo-table,osrd,trainruns,altrios", "out", *arguments, folder=folder)
    return folder / "learned"


@pytest.fixture(scope="session")
def train(exported):
    return tomllib.loads((exported / "train.toml").read_text())


def resistance_n(train, speed_mps):
    """Running resistance of the whole train, N."""
    davis = train["davis"]
    per_mass = davis["r0"] + davis["r1"] * speed_mps + davis["r2"] * speed_mps**2
    return train["rotating_mass_factor"] * train["mass_kg"] * per_mass


def sumo_speeds(vtype, depart_mps, folder):
    """Speeds of a train on a level line, each 0.1 s, m/s."""
    import sumo

    programs = pathlib.Path(sumo.SUMO_HOME) / "bin"
    (folder / "line.nod.xml").write_text('<nodes><node id="a" x="0" y="0"/><node id="b" x="90000" y="0"/></nodes>')
    (folder / "line.edg.xml").write_text('<edges><edge id="line" from="a" to="b" allow="rail" speed="80"/></edges>')
    network = ["-n", "line.nod.xml", "-e", "line.edg.xml", "-o", "line.net.xml"]
    run(str(programs / "netconvert"), *network, folder=folder)
    route = f'<route id="r" edges="line"/><vehicle id="t" type="{vtype.get("id")}" route="r" depart="0"'
    text = xml.etree.ElementTree.tostring(vtype, encoding="unicode")
    vehicle = f'{route} departPos="1000" departSpeed="{depart_mps}"/>'
    (folder / "line.rou.xml").write_text(f"<routes>{text}{vehicle}</routes>")
    files = ["-n", "line.net.xml", "-r", "line.rou.xml", "--fcd-output", "speeds.xml"]
    steps = ["--step-length", "0.1", "--end", "10", "--precision", "9", "--xml-validation", "never"]
    said = run(str(programs / "sumo"), *files, *steps, "--no-step-log", folder=folder)
    assert "Warning" not in said and "Error" not in said, said
    rows = xml.etree.ElementTree.parse(folder / "speeds.xml").iter("vehicle")
    return [float(row.get("speed")) for row in rows]


def test_sumo_slows_down_by_the_learned_resistance(exported, train, tmp_path):
    vtype = xml.etree.ElementTree.parse(exported / "sumo.add.xml").find("vType")
    # SUMO does not coast: the traction is taken away, all else stays.
    vtype.set("maxPower", "0")
    vtype.set("maxTraction", "0")
    speeds = sumo_speeds(vtype, SPEED_MPS, tmp_path)
    expected_mps2 = resistance_n(train, SPEED_MPS) / (train["rotating_mass_factor"] * train["mass_kg"])
    found_mps2 = (speeds[0] - speeds[1]) / 0.1
    assert found_mps2 == pytest.approx(expected_mps2, rel=1e-3)


def test_sumo_slows_down_by_the_table_of_resistance(exported, train, tmp_path):
    vtype = xml.etree.ElementTree.parse(exported / "sumo.table.add.xml").find("vType")
    vtype.set("tractionTable", " ".join("0" for _ in vtype.get("speedTable").split()))
    speeds = sumo_speeds(vtype, SPEED_MPS, tmp_path)
    expected_mps2 = resistance_n(train, SPEED_MPS) / (train["rotating_mass_factor"] * train["mass_kg"])
    assert (speeds[0] - speeds[1]) / 0.1 == pytest.approx(expected_mps2, rel=1e-3)


@pytest.mark.parametrize("file", ["sumo.add.xml", "sumo.table.add.xml"])
def test_sumo_powers_with_the_largest_effort(exported, train, tmp_path, file):
    vtype = xml.etree.ElementTree.parse(exported / file).find("vType")
    speeds = sumo_speeds(vtype, 1, tmp_path)
    net_n = train["max_tractive_effort_n"] - resistance_n(train, 1)
    expected_mps2 = net_n / (train["rotating_mass_factor"] * train["mass_kg"])
    assert (speeds[1] - speeds[0]) / 0.1 == pytest.approx(expected_mps2, rel=1e-3)


def test_altrios_computes_the_learned_resistance(exported, train):
    vehicle = altrios.RailVehicle.from_file(str(exported / "altrios.yaml"))
    name = yaml.safe_load(vehicle.to_yaml())["car_type"]
    config = altrios.TrainConfig([vehicle], {name: 1}, altrios.TrainType.Passenger)
    # Locomotives and line are ALTRIOS's own; the speed is given.
    consist = altrios.Consist([altrios.Locomotive.default()] * 8, 1)
    builder = altrios.TrainSimBuilder(train_id="0", train_config=config, loco_con=consist)
    resources = altrios.resources_root()
    simulation = builder.make_set_speed_train_sim(
        network=altrios.Network.from_file(resources / "networks/Taconite-NoBalloon.yaml"),
        link_path=altrios.LinkPath.from_csv_file(resources / "demo_data/link_path.csv"),
        speed_trace=altrios.SpeedTrace([0.0, 1.0, 2.0, 3.0], [SPEED_MPS] * 4),
        save_interval=1,
    )
    simulation.walk()
    last = simulation.to_dataframe().tail(1).to_dicts()[0]
    found_n = {kind: last[f"history.res_{kind}_newtons"] for kind in ["rolling", "davis_b", "bearing", "aero"]}
    # Terms by weight include the locomotives', which the learned train already has.
    share = train["mass_kg"] / last["history.mass_static_kilograms"]
    total_n = share * (found_n["rolling"] + found_n["davis_b"]) + found_n["bearing"] + found_n["aero"]
    assert total_n == pytest.approx(resistance_n(train, SPEED_MPS), rel=1e-3)
    rotating_kg = (train["rotating_mass_factor"] - 1) * train["mass_kg"]
    assert last["history.mass_rot_kilograms"] == pytest.approx(rotating_kg, rel=1e-5)


def test_trainruns_has_the_learned_resistance(exported, train):
    """TrainRuns.jl is a Julia package: its published equations, applied to the file as any YAML reader sees it."""
    file = yaml.safe_load((exported / "trainruns.yaml").read_text())
    assert file["schema"] == "https://railtoolkit.org/schema/rolling-stock.json"
    assert re.fullmatch(r"[2-9]\d{3}\.[01]\d", file["schema_version"])
    vehicles = {vehicle["id"]: vehicle for vehicle in file["vehicles"]}
    formation = [vehicles[name] for name in file["trains"][0]["formation"]]
    found_n = 0.0
    for vehicle in formation:
        kind = vehicle["vehicle_type"]
        assert kind in ["traction unit", "freight", "passenger"]
        assert all(vehicle.get(name, 1) > 0 for name in ["base_resistance", "rolling_resistance", "air_resistance"])
        wind = 0.0 if kind == "freight" else 15.0
        permille = vehicle["base_resistance"] + vehicle.get("air_resistance", 0) * ((100 + wind) / 100) ** 2
        permille += vehicle.get("rolling_resistance", 0) if kind == "passenger" else 0
        found_n += permille / 1000 * 1000 * vehicle["mass"] * GRAVITY_MPS2
    assert found_n == pytest.approx(resistance_n(train, SPEED_MPS), rel=1e-3)
    curve = next(vehicle["tractive_effort"] for vehicle in formation if "tractive_effort" in vehicle)
    assert len(curve) >= 3 and curve[0] == [0, pytest.approx(train["max_tractive_effort_n"], rel=1e-6)]
    assert curve[-1][0] * curve[-1][1] / 3.6 == pytest.approx(train["max_power_w"], rel=1e-6)
