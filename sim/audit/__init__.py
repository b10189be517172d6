"""The auditor of the actuator limits: judges any log; on purpose without code of scheduler or interlock."""
