"""Virtual rigs with one concealed physical effect each, and the blind test of a diagnosis on them.

Nothing here imports the product: the rigs' physics, integrator and noise are a second, independent work.
"""
