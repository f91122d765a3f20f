"""A random agent splits the torque in a double lane change: the loop that any learner runs, two episodes of it."""

import gymnasium

import ev_doors.learning  # noqa: F401, registers the environments

environment = gymnasium.make(
    "ev_stack/TorqueSplit-v0", observe=("twist", "imu.yaw_rate"), duration=2.0
)
environment = gymnasium.wrappers.RescaleAction(environment, -1.0, 1.0)
environment.action_space.seed(1)
for seed in (1, 2):
    observation, info = environment.reset(seed=seed)
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = environment.step(
            environment.action_space.sample()
        )
        total, over = total + reward, terminated or truncated
    print(
        f"seed {seed}: {info['time']:.2f} s, speed {observation[0]:.3f} m/s, sum of rewards"
        f" {total:.6f}"
    )
environment.close()
