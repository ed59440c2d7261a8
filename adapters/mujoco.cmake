# The mujoco adapter.
