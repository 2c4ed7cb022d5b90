"""How many threads torch is given."""


def test_busy_machine_gets_one_thread(stable_baselines, monkeypatch):
    import torch

    from pliant.controllers.learning import torch_threads

    before = torch.get_num_threads()
    monkeypatch.setattr(torch_threads, "available", lambda: 2)
    monkeypatch.setattr(torch_threads.os, "getloadavg", lambda: (1.5, 0.0, 0.0), raising=False)
    assert torch_threads.choose() == (1, "the machine is busy, load 1.5")
    monkeypatch.setattr(torch_threads.os, "getloadavg", lambda: (0.5, 0.0, 0.0), raising=False)
    for seconds, wanted in (({1: 1.0, 2: 0.6}, 2), ({1: 1.0, 2: 0.95}, 1), ({1: 1.0, 2: 30.0}, 1)):
        monkeypatch.setattr(torch_threads, "_seconds", seconds.get)
        threads, why = torch_threads.choose()
        assert threads == wanted and "2 threads take" in why
    monkeypatch.setattr(torch_threads, "available", lambda: 1)
    assert torch_threads.choose() == (1, "one processor")
    torch.set_num_threads(before)
