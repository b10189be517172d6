"""From field and Sun to attitude, rate, bias and disturbance torque."""
