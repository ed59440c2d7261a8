#!/usr/bin/env python3
"""An engine for brickbench in one file, with the standard library alone.

The upper half is the protocol (docs/protocol.md) and can stay as it is. The lower half is an engine
without contact: semi-implicit Euler, and a refusal where bodies may touch. Replace it by your own.
"""
import json
import math
import os
import struct
import sys
import time

# ---- the protocol ----


class Refusal(Exception):
    """The engine cannot do this: the fault is one word of the protocol, the reason one sentence."""

    def __init__(self, reason, fault="refused"):
        super().__init__(reason)
        self.fault = fault


class State:
    """Of one body: world frame, quaternion w, x, y, z from body to world, centre of mass."""

    def __init__(self, position_m, orientation, velocity_mps, angular_velocity_radps):
        self.position_m = list(position_m)
        self.orientation = list(orientation)
        self.velocity_mps = list(velocity_mps)
        self.angular_velocity_radps = list(angular_velocity_radps)

    def numbers(self):
        return self.position_m + self.orientation + self.velocity_mps + self.angular_velocity_radps


def states_of(payload):
    return [State(n[0:3], n[3:7], n[7:10], n[10:13]) for n in struct.iter_unpack("<13d", payload)]


def initial_states(world):
    keys = ("position_m", "orientation", "velocity_mps", "angular_velocity_radps")
    return [State(*(body["initial"][key] for key in keys)) for body in world["bodies"]]


def record(states, cpu_s):
    """One step as it travels: time, no flags, no diagnostics, the states."""
    numbers = [number for state in states for number in state.numbers()]
    return struct.pack(f"<dIIQ{len(numbers)}d", cpu_s, 0, 0, 0, *numbers)


def step_many(engine, payload):
    count = struct.unpack_from("<Q", payload)[0]
    wrenches = [(n[0:3], n[3:6]) for n in struct.iter_unpack("<6d", payload[8:])]
    records = []
    for _ in range(count):
        begun_s = time.process_time()
        engine.step(wrenches)
        records.append(record(engine.states, time.process_time() - begun_s))
        wrenches = []  # they act in the first step alone
    return "states", b"".join(records)


def answer(engine, word, payload):
    """The word and the payload of the answer."""
    if word == "hello":
        protocol = json.loads(payload)["protocol"]
        if protocol != 1:
            raise Refusal(f"this engine speaks protocol 1, not {protocol}")
        return "hello", json.dumps({"protocol": 1, **engine.hello()}).encode()
    if word == "build":
        order = json.loads(payload)
        begun_s = time.process_time()
        engine.build(order["world"], order["settings"])
        cpu_s = time.process_time() - begun_s
        return "built", json.dumps({"views": engine.views, "cpu_s": cpu_s}).encode()
    if word == "step":
        return step_many(engine, payload)
    if word == "read":
        return "states", record(engine.states, 0.0)
    if word == "setstate":
        engine.set_state(states_of(payload))
        return "done", b""
    if word == "audit":
        return "audit", json.dumps(engine.audit()).encode()
    if word == "pairlaw":
        return "pairlaw", struct.pack("<2d", *engine.pair_law(*struct.unpack("<2Q", payload)))
    raise Refusal(f"'{word}' is not offered", "invalid")


def serve(engine):
    """Answers questions until there are no more."""
    # What anyone prints goes to standard error: only frames belong on standard output.
    frames = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    questions = sys.stdin.buffer
    while len(head := questions.read(16)) == 16:
        word, size = struct.unpack("<8sQ", head)
        try:
            said, payload = answer(engine, word.decode().rstrip(), questions.read(size))
        except Refusal as refusal:
            said = "failed"
            payload = json.dumps({"fault": refusal.fault, "reason": str(refusal)}).encode()
        frames.write(struct.pack("<8sQ", said.ljust(8).encode(), len(payload)) + payload)
        frames.flush()


# ---- the engine ----


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def product(p, q):
    """Of two quaternions."""
    v = cross(p[1:], q[1:])
    return [p[0] * q[0] - sum(a * b for a, b in zip(p[1:], q[1:]))] + [
        p[0] * q[i] + q[0] * p[i] + v[i - 1] for i in (1, 2, 3)]


def rotated(q, v):
    t = [2.0 * x for x in cross(q[1:], v)]
    u = cross(q[1:], t)
    return [v[i] + q[0] * t[i] + u[i] for i in range(3)]


def conjugate(q):
    return [q[0], -q[1], -q[2], -q[3]]


def turn(angle_rad):
    """The rotation by a vector, axis times angle."""
    angle = math.sqrt(sum(x * x for x in angle_rad))
    if not 0.0 < angle < math.inf:
        return [1.0, 0.0, 0.0, 0.0]
    share = math.sin(0.5 * angle) / angle
    return [math.cos(0.5 * angle)] + [share * x for x in angle_rad]


def shortest(number):
    """The shortest text that reads back to the same number; whole numbers without a point."""
    return repr(float(number)).removesuffix(".0")


def bounding_radius_m(shape):
    if shape["kind"] == "box":
        return math.sqrt(sum(x * x for x in shape["half_extents_m"]))
    return shape["radius_m"]


class FreeFlight:
    """Bodies that fall, turn and are pushed, and that may not touch."""

    views = ["set_state", "audit"]

    def hello(self):
        return {
            "name": "free flight in Python", "version": "1", "shapes": ["box", "sphere", "plane"],
            "variants": [{"name": "default", "meaning": "no contact: refuses to touch",
                          "precision": "f64", "knobs": {"clearance_m": 0.0}}],
            "knobs": [{"name": "clearance_m", "unit": "m", "engine_default": 0.0, "min": 0.0,
                       "max": 1000.0,
                       "meaning": "the step is refused where bounding spheres come closer"}]}

    def build(self, world, settings):
        self.world = world
        self.step_s = settings["step_s"]
        self.clearance_m = settings["knobs"]["clearance_m"]
        self.states = initial_states(world)

    def set_state(self, states):
        for body, now, wanted in zip(self.world["bodies"], range(len(states)), states):
            if not body["fixed"]:
                self.states[now] = wanted

    def step(self, wrenches):
        """Advances by exactly step_s; a wrench is (force_n, torque_nm) of each body, or none at all."""
        for i, body in enumerate(self.world["bodies"]):
            if not body["fixed"]:
                self.advance(body, self.states[i], wrenches[i] if wrenches else ((0,) * 3, (0,) * 3))
        self.refuse_contact()

    def advance(self, body, state, wrench):
        h, gravity, inertia = self.step_s, self.world["gravity_mps2"], body["inertia_kgm2"]
        for k in range(3):
            state.velocity_mps[k] += h * (gravity[k] + wrench[0][k] / body["mass_kg"])
            state.position_m[k] += h * state.velocity_mps[k]
        to_body = conjugate(state.orientation)
        spin = rotated(to_body, state.angular_velocity_radps)
        gyroscopic = cross(spin, [inertia[k] * spin[k] for k in range(3)])
        torque = rotated(to_body, wrench[1])
        spin = [spin[k] + h * (torque[k] - gyroscopic[k]) / inertia[k] for k in range(3)]
        q = product(state.orientation, turn([h * x for x in spin]))
        length = math.sqrt(sum(x * x for x in q))
        state.orientation = [x / length for x in q]
        state.angular_velocity_radps = rotated(state.orientation, spin)

    def gap_m(self, i, k):
        shape = self.world["bodies"][k]["shape"]
        a, b = self.states[i], self.states[k]
        apart = [a.position_m[n] - b.position_m[n] for n in range(3)]
        radius_m = bounding_radius_m(self.world["bodies"][i]["shape"])
        if shape["kind"] == "plane":
            up = rotated(b.orientation, [0.0, 0.0, 1.0])
            return sum(x * y for x, y in zip(apart, up)) - radius_m
        return math.sqrt(sum(x * x for x in apart)) - radius_m - bounding_radius_m(shape)

    def refuse_contact(self):
        bodies = self.world["bodies"]
        for i in range(len(bodies)):
            for k in range(len(bodies)):
                if i != k and not bodies[i]["fixed"] and self.gap_m(i, k) <= self.clearance_m:
                    raise Refusal(f"'{bodies[i]['name']}' and '{bodies[k]['name']}' may touch, "
                                  "and this engine has no contact")

    def audit(self):
        """What the live engine holds: here its world is all that it has."""
        still = {"linear_damping_hz": 0.0, "angular_damping_hz": 0.0, "can_sleep": False}
        return {"gravity_mps2": self.world["gravity_mps2"],
                "bodies": [{"fixed": body["fixed"], "shape": body["shape"], **still,
                            "mass_kg": 0.0 if body["fixed"] else body["mass_kg"],
                            "inertia_kgm2": [0.0] * 3 if body["fixed"] else body["inertia_kgm2"]}
                           for body in self.world["bodies"]],
                "settings": [{"name": "step_s", "unit": "s", "value": shortest(self.step_s)},
                             {"name": "clearance_m", "unit": "m",
                              "value": shortest(self.clearance_m)}]}

    def pair_law(self, a, b):
        surfaces = {self.world["bodies"][a]["surface"], self.world["bodies"][b]["surface"]}
        law = self.world["law"]
        for pair in self.world["exceptions"]:
            if {pair["surface_a"], pair["surface_b"]} == surfaces:
                law = pair["law"]
        return law["friction"], law["restitution"]


if __name__ == "__main__":
    serve(FreeFlight())
