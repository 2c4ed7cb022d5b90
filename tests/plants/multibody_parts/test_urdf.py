"""Bad URDF files, one table: each a ValueError that names the element and the value."""

import pytest

from pliant.plants import FlexibleTree
from pliant.plants.multibody_parts.urdf import read

INERTIA = '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/>'
HEAVY = f'<inertial><mass value="2"/>{INERTIA}</inertial>'
LINKS = f'<link name="base"/><link name="a">{HEAVY}</link><link name="b">{HEAVY}</link>'


def joint(name, parent, child, inside="", kind="revolute"):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


J1, J2 = joint("j1", "base", "a"), joint("j2", "a", "b")


def robot(links=LINKS, joints=J1 + J2):
    return f'<robot name="r">{links}{joints}</robot>'


def link(inside):
    return robot(f'<link name="base"/><link name="a">{inside}</link><link name="b">{HEAVY}</link>')


def first(inside, kind="revolute"):
    return robot(joints=joint("j1", "base", "a", inside, kind) + J2)


def tensor(**changes):
    values = {"ixx": "0.03", "ixy": "0", "ixz": "0", "iyy": "0.03", "iyz": "0", "izz": "0.01"} | changes
    words = " ".join(f'{k}="{v}"' for k, v in values.items() if v is not None)
    return link(f'<inertial><mass value="2"/><inertia {words}/></inertial>')


def mass(value, inertia=INERTIA):
    return link(f'<inertial><mass value="{value}"/>{inertia}</inertial>')


NONE = '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'
TABLE = {
    "empty": ("", r"from_urdf\.path = .* must be XML: no element found"),
    "no XML": ("robot: arm", r"from_urdf\.path = .* must be XML"),
    "cut off": (robot()[:-20], r"must be XML"),
    "other root": ("<sdf/>", r"its root is <sdf>, must be <robot>"),
    "entities": ('<!DOCTYPE r [<!ENTITY a "b">]><robot/>', r"declares entities, must have none"),
    "no links": ("<robot/>", r"has no <link>, must have one at least"),
    "no joints": ('<robot><link name="base"/></robot>', r"FlexibleTree\.bodies = \(\) must be one body at least"),
    "nameless link": (robot("<link/>"), r"<link>: name = None must be a name"),
    "blank link": (robot('<link name=" "/>'), r"<link>: name = ' ' must be a name"),
    "nameless joint": (robot(joints="<joint/>"), r"<joint>: name = None must be a name"),
    "link twice": (robot(LINKS + '<link name="a"/>'), r"link 'a' stands there twice"),
    "joint twice": (robot(joints=J1 + joint("j1", "a", "b")), r"joint 'j1' stands there twice"),
    "two inertials": (link(HEAVY + HEAVY), r"link 'a' has 2 elements <inertial>, must have one"),
    "no mass": (link(f"<inertial>{INERTIA}</inertial>"), r"link 'a' inertial has no <mass>"),
    "no inertia": (link('<inertial><mass value="1"/></inertial>'), r"link 'a' inertial has no <inertia>"),
    "mass without value": (link(f"<inertial><mass/>{INERTIA}</inertial>"), r"link 'a' mass value = None must be one"),
    "mass of words": (mass("heavy"), r"link 'a' mass value = 'heavy' must be one finite number \[kg\]"),
    "mass NaN": (mass("nan"), r"link 'a' mass value = 'nan' must be one finite number"),
    "mass infinite": (mass("inf"), r"link 'a' mass value = 'inf' must be one finite number"),
    "two masses": (mass("1 2"), r"link 'a' mass value = '1 2' must be one finite number"),
    "negative mass": (mass("-1"), r"link 'a' mass value = -1\.0 must be >= 0 \[kg\]"),
    "inertia of nothing": (mass("0"), r"link 'a' has mass value = 0\.0 and an inertia, must have both or neither"),
    "no inertia of mass": (
        mass("2", NONE),
        r"'a' has mass value = 2\.0 and no inertia, must have both where joint 'j1'",
    ),
    "nothing to move": (
        robot(LINKS.replace(HEAVY, "")),
        r"'j2' moves link 'b' of mass = 0\.0 and nothing heavier",
    ),
    "zero mass": (robot(LINKS.replace("2", "0").replace(INERTIA, NONE)), r"joint 'j2' moves link 'b' of mass = 0\.0"),
    "lacks izz": (tensor(izz=None), r"link 'a' inertia izz = None must be one finite number"),
    "inertia NaN": (tensor(iyy="NaN"), r"link 'a' inertia iyy = 'NaN' must be one finite number \[kg m\^2\]"),
    "inertia of words": (tensor(ixy="small"), r"link 'a' inertia ixy = 'small' must be one finite number"),
    "negative moment": (tensor(ixx="-0.03"), r"link 'a' inertia = .* must have principal moments >= 0 .*, has -0\.03"),
    "product too large": (tensor(ixy="0.05"), r"link 'a' inertia = .* must have principal moments >= 0"),
    "no triangle": (tensor(izz="0.07"), r"link 'a' inertia = .* no principal moment above the sum .* 0\.07 > 0\.06"),
    "centre NaN": (
        link(f'<inertial><origin xyz="0 nan 0"/><mass value="2"/>{INERTIA}</inertial>'),
        r"link 'a' inertial origin xyz = '0 nan 0' must be 3 finite numbers \[m\]",
    ),
    "centre of two": (
        link(f'<inertial><origin xyz="0 1"/><mass value="2"/>{INERTIA}</inertial>'),
        r"link 'a' inertial origin xyz = '0 1' must be 3 finite numbers",
    ),
    "axes of words": (
        link(f'<inertial><origin rpy="a b c"/><mass value="2"/>{INERTIA}</inertial>'),
        r"link 'a' inertial origin rpy = 'a b c' must be 3 finite numbers \[rad\]",
    ),
    "no type": (robot(joints='<joint name="j1"/>'), r"joint 'j1' type = None must be one of revolute, continuous"),
    "screw": (first("", "screw"), r"joint 'j1' type = 'screw' must be one of"),
    "damped plane": (
        first('<dynamics damping="1"/>', "planar"),
        r"joint 'j1' dynamics damping = 1\.0 must be 0 where type = 'planar': the format does not say of what",
    ),
    "rubbed float": (
        first('<dynamics friction="1"/>', "floating"),
        r"joint 'j1' dynamics friction = 1\.0 must be 0 where type = 'floating'",
    ),
    "plane without normal": (
        first('<axis xyz="0 0 0"/>', "planar"),
        r"joint 'j1' axis xyz = .* must have a length > 0",
    ),
    "mimic": (first('<mimic joint="j2"/>'), r"joint 'j1' mimics joint 'j2': a tree has no joint that follows"),
    "no parent": (
        robot(joints='<joint name="j1" type="fixed"><child link="a"/></joint>'),
        r"joint 'j1' has no <parent>, must have one",
    ),
    "no child": (
        robot(joints='<joint name="j1" type="fixed"><parent link="a"/></joint>'),
        r"joint 'j1' has no <child>, must have one",
    ),
    "two parents": (first('<parent link="b"/>'), r"joint 'j1' has 2 elements <parent>, must have one"),
    "parent unnamed": (
        robot(joints='<joint name="j1" type="fixed"><parent/><child link="a"/></joint>'),
        r"joint 'j1' parent: link = None must be a name",
    ),
    "unknown parent": (
        robot(joints=joint("j1", "bas", "a") + J2),
        r"'j1' parent link = 'bas' must be one of base, a",
    ),
    "unknown child": (
        robot(joints=J1 + joint("j2", "a", "c")),
        r"'j2' child link = 'c' must be one of base, a, b",
    ),
    "two joints to a link": (
        robot(joints=J1 + J2 + joint("j3", "base", "b")),
        r"link 'b' is the child of joints 'j2' and 'j3', must be of one: a closed loop is no tree",
    ),
    "loop": (robot(joints=J1 + J2 + joint("j3", "b", "base")), r"joints j1, j2, j3 close a loop"),
    "loop apart": (
        robot(joints=joint("j1", "a", "b") + joint("j2", "b", "a")),
        r"joints 'j1', 'j2' close a loop that does not hang on the base 'base'",
    ),
    "onto itself": (robot(joints=J1 + joint("j2", "b", "b")), r"joints 'j2' close a loop that does not hang"),
    "a link alone": (robot(joints=J1), r"links 'base', 'b' have no joint above them, must be one link alone"),
    "origin NaN": (first('<origin xyz="nan 0 0"/>'), r"joint 'j1' origin xyz = 'nan 0 0' must be 3 finite numbers"),
    "origin of four": (first('<origin rpy="0 0 0 1"/>'), r"joint 'j1' origin rpy = '0 0 0 1' must be 3 finite numbers"),
    "two origins": (first("<origin/><origin/>"), r"joint 'j1' has 2 elements <origin>, must have one"),
    "axis zero": (first('<axis xyz="0 0 0"/>'), r"joint 'j1' axis xyz = \(0\.0, 0\.0, 0\.0\) must have a length > 0"),
    "axis NaN": (first('<axis xyz="0 0 nan"/>'), r"joint 'j1' axis xyz = '0 0 nan' must be 3 finite numbers"),
    "axis of one": (first('<axis xyz="1"/>'), r"joint 'j1' axis xyz = '1' must be 3 finite numbers"),
    "axis unsaid": (first("<axis/>"), r"joint 'j1' axis xyz = None must be 3 finite numbers"),
    "damping < 0": (first('<dynamics damping="-1"/>'), r"joint 'j1' dynamics damping = -1\.0 must be >= 0"),
    "damping NaN": (first('<dynamics damping="nan"/>'), r"joint 'j1' dynamics damping = 'nan' must be one finite"),
    "friction < 0": (first('<dynamics friction="-1"/>'), r"joint 'j1' dynamics friction = -1\.0 must be >= 0"),
    "limits crossed": (
        first('<limit lower="1" upper="0"/>'),
        r"'j1' limit lower = 1\.0 must be at most upper = 0\.0",
    ),
    "limit NaN": (first('<limit lower="nan"/>'), r"joint 'j1' limit lower = 'nan' must be one finite number"),
    "effort < 0": (first('<limit effort="-5"/>'), r"joint 'j1' limit effort = -5\.0 must be >= 0"),
    "speed of words": (
        first('<limit velocity="fast"/>'),
        r"'j1' limit velocity = 'fast' must be one finite number",
    ),
    "only fixed": (
        robot(joints=joint("j1", "base", "a", kind="fixed") + joint("j2", "a", "b", kind="fixed")),
        r"FlexibleTree\.bodies = \('a', 'b'\) must have a joint that moves",
    ),
}


def test_the_good_one_is_taken(tmp_path):
    path = tmp_path / "good.urdf"
    path.write_text(robot(joints=J2 + J1))
    machine = read(path)
    assert [j.name for j in machine.joints] == ["j1", "j2"]
    assert machine.root == "base"
    assert FlexibleTree.from_urdf(path).nx == 4
    assert len(TABLE) >= 60


@pytest.mark.parametrize("name", TABLE)
def test_refused(tmp_path, name):
    text, words = TABLE[name]
    path = tmp_path / "bad.urdf"
    path.write_text(text)
    with pytest.raises(ValueError, match=words):
        FlexibleTree.from_urdf(path)


def test_points_of_mass_and_axes_of_nothing_are_taken_where_they_are_welded(tmp_path):
    """As exporters write them: a welded link's mass alone, a fixed joint's axis 0 0 0."""
    links = (
        LINKS.replace("</inertial></link>", "</inertial></link>", 1)
        + f'<link name="c">{HEAVY.replace(INERTIA, NONE)}</link>'
    )
    weld = joint("j3", "b", "c", '<origin xyz="1 0 0"/><axis xyz="0 0 0"/>', "fixed")
    path = tmp_path / "good.urdf"
    path.write_text(robot(links, joint("j1", "base", "a", kind="fixed") + J2 + weld))
    tree = FlexibleTree.from_urdf(path)
    assert abs(float(tree.mass_matrix([0, 0])[0, 0]) - 0.03) < 1e-12  # about x, on which the point lies


def test_no_file(tmp_path):
    with pytest.raises(ValueError, match=r"from_urdf\.path = .*none\.urdf' must be a file that can be read"):
        FlexibleTree.from_urdf(tmp_path / "none.urdf")
    with pytest.raises(ValueError, match=r"from_urdf\.path is a int, must be a path"):
        FlexibleTree.from_urdf(3)


def test_joints_of_several_freedoms(tmp_path):
    """A floating base link, a ball and a plane; none has an input unless `drives` says so."""
    path = tmp_path / "good.urdf"
    links = LINKS + f'<link name="c">{HEAVY}</link>'
    joints = joint("j1", "base", "a", "", "floating") + joint("j2", "a", "b", "", "spherical")
    path.write_text(robot(links, joints + joint("j3", "b", "c", '<axis xyz="0 0 1"/>', "planar")))
    tree = FlexibleTree.from_urdf(path, drives={"j3": "torque"})
    assert [j.kind for j in tree.moving] == ["free", "spherical", "planar"]
    assert [s.name for s in tree.inputs] == ["j3_force_x", "j3_force_y", "j3_torque"]
    assert (len(tree.coordinates), len(tree.speeds)) == (14, 12)


@pytest.mark.parametrize("base", ["free", "driven"])
def test_the_root_link_is_a_base_that_moves(tmp_path, base):
    path = tmp_path / "good.urdf"
    path.write_text(robot(LINKS.replace('<link name="base"/>', f'<link name="base">{HEAVY}</link>')))
    tree = FlexibleTree.from_urdf(path, base=base)
    assert tree.platform.mass == 2.0
    assert tree.coordinates[0].name == "base_x"


def test_repairs_are_told(tmp_path):
    path = tmp_path / "real.urdf"
    path.write_text(tensor(izz="0.07"))
    with pytest.warns(UserWarning, match=r"has inertias that no body has: link 'a': its principal moments .* became"):
        tree = FlexibleTree.from_urdf(path, inertias="repair")
    assert len(tree.repairs) == 1
    assert tree.bodies[0].inertia[0][0] == pytest.approx(0.035)
    with pytest.raises(ValueError, match=r"from_urdf\.inertias = 'keep' must be one of 'refuse', 'repair'"):
        FlexibleTree.from_urdf(path, inertias="keep")
