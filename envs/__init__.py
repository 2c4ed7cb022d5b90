if __name__ != "pliant.envs":
    raise ImportError("this folder is installed as pliant.envs: write `import pliant.envs`")
