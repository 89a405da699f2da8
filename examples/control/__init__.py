"""Controllers designed with an identified model, run against its FMU."""
