"""Parameters of contact laws from a material or from one measurement, as the command line prints them."""

import json
import subprocess
import sys

import pytest

import taxelsim


def test_pin_of_the_paper_as_springs_and_as_a_layer():
    press = taxelsim.PinPress(pin_force=2, pin_depth=0.001, pin_diameter=0.001)
    stiffness = taxelsim.skin_stiffness(taxelsim.SkinData(thickness=0.002, stiffness=press))
    assert stiffness.area_stiffness == pytest.approx(2.546e9, rel=1e-3)
    skins = taxelsim.skins_of(stiffness, friction_coefficient=0.5)
    laws = ["Winkler", "MassSpringDamper", "DeformationMask", "Proximity", "ElasticLayer", "LuGre"]
    assert [type(skin.law).__name__ for skin in skins] == laws
    for skin in skins:
        assert taxelsim.pin_force(skin, 0.001, 0.001) == pytest.approx(2)
        assert taxelsim.pin_depth(skin, 0.001, 2) == pytest.approx(0.001)
    assert skins[4].friction.tangential_stiffness == stiffness.tangential_stiffness
    assert skins[5].friction.friction_coefficient == 0


def test_the_numbers_of_the_command_line():
    options = ["--shore-a", "40", "--thickness", "0.003", "--match-pin-diameter", "0.005", "--json"]
    command = [sys.executable, "-m", "taxelsim", "stiffness", *options]
    printed = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
    modulus = taxelsim.shore_a_modulus(40)
    known = taxelsim.KnownModulus(elastic_modulus=modulus, match_pin_diameter=0.005)
    stiffness = taxelsim.skin_stiffness(taxelsim.SkinData(thickness=0.003, stiffness=known))
    assert printed["elastic_modulus"] == modulus == stiffness.material.elastic_modulus
    assert printed["area_stiffness"] == stiffness.area_stiffness
    assert printed["shear_modulus"] == taxelsim.shear_modulus(stiffness.material)
    assert printed["confined_modulus"] == taxelsim.confined_modulus(stiffness.material)


def test_three_stiffnesses_are_three_classes():
    taxel = taxelsim.TaxelStiffness(taxel_stiffness=2000, pitch=(0.002, 0.004))
    area = taxelsim.AreaStiffness(area_stiffness=2.5e8)
    results = [taxelsim.skin_stiffness(taxelsim.SkinData(thickness=0.002, poisson_ratio=0.3, stiffness=known)) for known in (taxel, area)]
    assert results[0].area_stiffness == pytest.approx(results[1].area_stiffness)
    material = results[1].material
    assert taxelsim.confined_modulus(material) / 0.002 == pytest.approx(2.5e8)
    # A half-space: E / (1 - nu^2) x diameter, approached by a thick layer.
    expected = material.elastic_modulus / (1 - 0.09) * 1e-4
    assert taxelsim.layer_pin_stiffness(material, 0.1, 1e-4) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"poisson_ratio": 0.5}, "poisson_ratio: 0.5 is not allowed"),
        ({"thickness": 0}, "thickness: 0 is not allowed"),
        ({"stiffness": taxelsim.AreaStiffness(area_stiffness=-1)}, "area_stiffness: -1 is not allowed"),
    ],
)
def test_refuses_values_out_of_range(data, message):
    known = {"thickness": 0.002, "stiffness": taxelsim.KnownModulus(elastic_modulus=1e6)}
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.skin_stiffness(taxelsim.SkinData(**(known | data)))


def test_refuses_shore_a_out_of_range():
    with pytest.raises(taxelsim.InputError, match="20 to 90"):
        taxelsim.shore_a_modulus(95)
