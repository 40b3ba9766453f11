"""Pick and place with mobile bases: a state machine and the job's record."""
