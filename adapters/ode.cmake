# The ode adapter.
