"""A trained policy in C: observation scaling, a small network of tanh or relu, the limits of the inputs."""

from __future__ import annotations

import numpy as np

from pliant.controllers.learning.policy import Policy

from .c_text import Law, added, array, each, number

ACTIVATIONS = {"tanh": "TANH({0})", "relu": "{0} > 0 ? {0} : 0"}


def policy(law: Policy, p: str) -> Law:
    """u = limits * clip(net(z)), z = clip((y - goal - mean) / std). ValueError for one that has a memory."""
    if law.history:
        raise ValueError(f"export_c.what: Policy.history = {law.history} must be 0: its memory has no form in C yet")
    if law.hold > 1 or law._place is not None:
        raise ValueError(
            "export_c.what: a Policy whose commands last or are no shares of the limits has no form in C yet"
        )
    ny, nu, last = len(law.reads), len(law.inputs), len(law.weights)
    constants = array(f"{p}_shift", law._shift) + array(f"{p}_factor", law._factor) + array(f"{p}_limit", law.limits)
    widest = max(ny, *(len(b) for b in law.biases))
    act = f"int i;\nREAL a[{widest}], b[{widest}];\n" + each("i", ny, f"a[i] = (y[i] - {p}_shift[i]) * {p}_factor[i];")
    if np.isfinite(law.clip):
        top = number(law.clip)
        act += each("i", ny, f"a[i] = a[i] > {top} ? {top} : a[i] < -{top} ? -{top} : a[i];")
    z, h = "a", "b"
    for k, (W, bias) in enumerate(zip(law.weights, law.biases), 1):
        units, inputs = W.shape
        constants += array(f"{p}_W{k}", W) + array(f"{p}_b{k}", bias)
        act += each("i", units, f"{h}[i] = {p}_b{k}[i];") + added(units, inputs, "1", f"{p}_W{k}", z, h)
        if k < last:
            act += each("i", units, f"{h}[i] = {ACTIVATIONS[law.activation].format(f'{h}[i]')};")
        z, h = h, z
    act += each("i", nu, f"u[i] = {p}_limit[i] * ({_squashed(law.squash, z)});")
    sizes = " x ".join(map(str, (ny, *(len(b) for b in law.biases))))
    return Law(p, f"policy of {sizes} units, {law.activation}", law.reads, nu, (), constants, "", "", act)


def _squashed(smooth: bool, z: str) -> str:
    return f"TANH({z}[i])" if smooth else f"{z}[i] > 1 ? 1 : {z}[i] < -1 ? -1 : {z}[i]"
