"""What a scene is made into for learning: rewards, sensors, delays, memory, drawn goals."""

from .channel import Channel
from .learning_units import Units
from .rewards import normalised
from .task import Task, TaskKeywords

__all__ = ["Channel", "Task", "TaskKeywords", "Units", "normalised"]
