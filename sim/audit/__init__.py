"""The auditor of the actuator limits: judges any log, shares no code with scheduler or interlock."""
