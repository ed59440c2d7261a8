# The bullet adapter.
