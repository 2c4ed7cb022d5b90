"""What a scene is made into for learning: rewards, sensors, delays, memory, drawn goals."""

from .actions import shares
from .channel import Channel
from .rewards import normalised
from .task import Task, TaskKeywords

__all__ = ["Channel", "Task", "TaskKeywords", "normalised", "shares"]
