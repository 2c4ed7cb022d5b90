"""A(t) of a linear model between its nodes, the transition matrix over a nominal, and what the data leave open.

interpolation      entries of A(t) between the nodes, with a bound on what is missed
state_matrix_path  A(t) as a function of time in scaled coordinates; which states may be judged alone
transition_error   the transition matrix and its error, entry by entry
eigenvalue_bounds  eigenvalues of every matrix within such an error
"""
