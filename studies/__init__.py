if __name__ != "pliant.studies":
    raise ImportError("this folder is installed as pliant.studies: write `import pliant.studies`")
