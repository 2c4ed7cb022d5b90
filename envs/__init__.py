"""Scenes wrapped for learning: `import pliant.envs` registers every scene as a Gymnasium environment."""

if __name__ != "pliant.envs":
    raise ImportError("this folder is installed as pliant.envs: write `import pliant.envs`")

from pliant.envs import adapters as adapters  # fills in Scene.puffer_env
from pliant.envs import gradients as gradients  # and Scene.differentiable
from pliant.envs import scene_files, scenes
from pliant.envs.environments import PlantEnv, environment_id, register
from pliant.envs.environments.scene_check import check_scene
from pliant.envs.scenes.scene import Scene
from pliant.envs.tasks import Task
from pliant.plants.core import imports

register()

__all__ = ["PlantEnv", "Scene", "Task", "check_scene", "environment_id", "scene_files", "scenes"]

imports.serve(
    __name__,
    {
        "scenes": "scene scene_checks=checks nominal=nominal_inputs arm_scenes=arms beam_scenes=beams "
        "mechanism_scenes=mechanisms spacecraft_scenes=spacecraft",
        "machines": "spacecraft_parts",
        "rendering": "render=planar render_space=spatial space_scenery=spacecraft_geometry",
        "simulation": "step=control_period kernel=control_kernel start=episode_start",
        "environments": "env vector=vector_env sb3=sb3_env",
    },
)
