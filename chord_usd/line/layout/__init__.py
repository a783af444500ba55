"""PlanImage -> LayoutImage: network, schedule, sampler."""
