"""From a learnt curve to the closed forms that lie within its band, and to a law file of the best one."""
