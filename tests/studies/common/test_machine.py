"""What the machine is, without its name."""

import platform

from pliant.studies.common import machine


def test_versions_and_no_host():
    found = machine.describe()
    assert found["python"].startswith(platform.python_version()) and found["pliant"] == machine.version("pliant")
    assert machine.cores() >= 1
    assert len(platform.node()) < 5 or not any(platform.node() in value for value in found.values())
