"""Loads and drives of the model: reference speed, torques, tables over time, slip law."""

from ltcgear.generated.contract import POSITIVE

from ..elements.key import ElementKey
from ..gears import train
from ..schema.scene_schema import Load
from .draft import Draft


def add_reference(draft: Draft) -> None:
    """Register the reference speed: a parameter, or the signals of a speed over time; none for a train at rest."""
    leads = {load.member: name for name, load in draft.scene.loads.items() if load.holds}
    lead = leads.get(draft.rigid.member, "")
    pairs = draft.scene.loads[lead].speed_over_time if lead else None
    if pairs is not None:
        key, table = f"loads.{lead}", f"loads.{lead}.speed_over_time"
        draft.signal("reference.speed", "rad/s", table, pairs, f"{key}.speed")
        draft.signal("reference.acceleration", "rad/s^2", table, pairs, f"{key}.acceleration", slope=True)
    elif draft.rigid.mode != "rest":
        draft.number("reference.speed", draft.rigid.speed, "rad/s")


def add_load(draft: Draft, name: str, load: Load) -> None:
    """Add the torque of a load; a prescribed speed is part of the motion, not an element."""
    key = f"loads.{name}"
    if load.slip is not None:
        slip = load.slip
        bind = {
            "omega_s": draft.number(f"{key}.synchronous_speed", slip.synchronous_speed, "rad/s"),
            "omega_b": draft.number(
                f"{key}.breakdown_slip_speed", train.breakdown_speed(slip), "rad/s", bounds=POSITIVE
            ),
            "T_b": draft.number(f"{key}.breakdown_torque", slip.breakdown_torque, "N*m"),
        }
        draft.place(key, ElementKey("slip_torque"), (load.member,), key, **bind)
    elif load.torque_over_time is not None:
        name = f"{key}.torque"
        torque = draft.signal(name, "N*m", f"{key}.torque_over_time", load.torque_over_time, name)
        draft.place(key, ElementKey("external_torque"), (load.member,), key, T=torque)
    elif load.torque is not None:
        torque = draft.number(f"{key}.torque", load.torque, "N*m")
        draft.place(key, ElementKey("external_torque"), (load.member,), key, T=torque)
