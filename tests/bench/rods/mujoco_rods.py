"""MuJoCo: a chain of capsules on ball joints with springs, and the cable of its elasticity plugin.

Twist is as stiff as bending in the chain, which the planar problem does not notice. The integrator
`discrete` takes springs implicitly. `implicitfast` takes only damping so: it is stable at 1/60 s
because hair's internal friction relaxes in more than half of that; less needs smaller steps.
"""

import math

import mujoco
import numpy as np

from rods import strand
from rods.strand import Row

INTEGRATORS = ("implicitfast", "discrete")
RESOLUTIONS = (5, 10, 20, 40)

HEAD = """
<compiler balanceinertia="true" boundmass="1e-12" boundinertia="1e-12"/>
<option timestep="{dt}" integrator="{integrator}" gravity="0 0 {gravity}">
  <flag constraint="disable" contact="disable"/>
</option>
"""


def chain(segments: int) -> str:
    """Equal capsules. A joint bends over a segment's length, the root's over half of one."""
    h = 1 / segments
    bodies = ""
    for i in range(segments):
        stiffness = strand.UNIT_BENDING / h * (2 if i == 0 else 1)
        bodies += (
            f'<body pos="{h if i else 0} 0 0"><joint type="ball" stiffness="{stiffness}" '
            f'damping="{stiffness * strand.RELAXATION}"/><geom type="capsule" mass="{h}" '
            f'size="{strand.UNIT_RADIUS}" fromto="0 0 0 {h} 0 0"/>'
        )
    return f"<worldbody>{bodies}{'</body>' * segments}</worldbody>"


def cable(segments: int) -> str:
    """The plugin's cable, whose first segment is fixed: the clamp is in that segment's middle."""
    h = strand.half_clamped(segments)
    return f"""
    <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
    <worldbody>
      <composite type="cable" curve="s 0 0" count="{segments + 1} 1 1" size="{h * segments} 0 0"
        offset="{-h / 2} 0 0" initial="none">
        <plugin plugin="mujoco.elasticity.cable">
          <config key="twist" value="{strand.UNIT_SHEAR_MODULUS}"/>
          <config key="bend" value="{strand.UNIT_YOUNG_MODULUS}"/>
        </plugin>
        <joint kind="main" damping="{strand.UNIT_BENDING / h * strand.RELAXATION}"/>
        <geom type="capsule" size="{strand.UNIT_RADIUS}" density="{strand.UNIT_DENSITY}"/>
      </composite>
    </worldbody>"""


def load(body: str, integrator: str, dt: float) -> tuple[mujoco.MjModel, mujoco.MjData]:
    head = HEAD.format(dt=dt, integrator=integrator, gravity=-strand.UNIT_GRAVITY)
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{head}{body}</mujoco>")
    return model, mujoco.MjData(model)


def tip(data: mujoco.MjData, h: float) -> tuple[float, float]:
    """End of the last body, which lies along its own x axis."""
    end = data.xpos[-1] + h * data.xmat[-1].reshape(3, 3)[:, 0]
    return float(end[0]), float(end[2])


def settle(body: str, integrator: str, dt: float, h: float) -> tuple[float, float] | None:
    """The tip at rest, or None without rest. Scaled joint rates scale every velocity: air drag."""
    model, data = load(body, integrator, dt)
    kept = math.exp(-strand.DRAG * dt)
    for _ in range(round(strand.SETTLING / dt)):
        mujoco.mj_step(model, data)
        data.qvel *= kept
    calm = np.isfinite(data.qvel).all() and np.abs(data.qvel).max() < strand.REST_SPEED
    return tip(data, h) if calm and data.warning.number.sum() == 0 else None


def rows() -> list[Row]:
    """Every model, integrator and resolution, with the largest step that comes to rest."""
    mujoco.set_mju_user_warning(lambda _: None)  # A step too large is an answer, not a log entry.
    mujoco.mj_loadAllPluginLibraries(f"{mujoco.__path__[0]}/plugin")
    result = []
    for integrator in INTEGRATORS:
        for name, make in (("ball chain", chain), ("cable", cable)):
            for segments in RESOLUTIONS:
                body = make(segments)
                h = 1 / segments if make is chain else strand.half_clamped(segments)
                found = strand.largest_stable(
                    lambda dt, b=body, h=h, i=integrator: settle(b, i, dt, h)
                )
                if found is None:
                    continue
                dt, end = found
                model, data = load(body, integrator, dt)
                us = strand.median_us(lambda n, m=model, d=data: mujoco.mj_step(m, d, n), 1000)
                label = f"mujoco {mujoco.__version__}, {name}, {integrator}"
                result.append(Row(label, segments, dt, us, strand.tip_error(*end)))
    return result
