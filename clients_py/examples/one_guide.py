"""One hair, from its physics to its motion. Needs a running `maned`."""

import numpy as np

import mane

hair = mane.Guide(root_frame=mane.frame_along((0, 1, 0)), length_m=0.2, element_count=5,
                  radius_1_m=5e-5, radius_2_m=4e-5, young_modulus_pa=3.9e9, poisson_ratio=0.48,
                  density_kg_m3=1300, internal_friction=5e-10, air_drag=5e-6,
                  natural_twist=0, natural_curvature_1=0, natural_curvature_2=15)  # fmt: skip
times = np.arange(120) / 60  # The head goes 0.1 m aside and back, twice in two seconds.
motion = mane.Motion(times, np.outer(0.05 - 0.05 * np.cos(2 * np.pi * times), (1, 0, 0)))
with mane.Client() as client:
    groom = client.create_groom([hair])
    at_rest = client.rest_shape(groom).positions  # (guide, point, 3), metres, head frame.
    with client.open_head(groom, "lockstep") as head:
        moving = np.stack([frame.positions for frame in head.play(motion)])
print(f"tip at rest {at_rest[0, -1]} m; in motion it spans {np.ptp(moving[:, 0, -1], 0)} m")
