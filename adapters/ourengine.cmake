# The ourengine adapter.
