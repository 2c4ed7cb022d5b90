if __name__ != "pliant.plants":
    raise ImportError("this folder is installed as pliant.plants: write `import pliant.plants`")
