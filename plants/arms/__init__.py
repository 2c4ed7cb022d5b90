"""Elastic robot arms of one and two links."""

from .single_link import SingleLinkArm
from .two_link import TwoLinkArm
from .two_link_paper_terms import Terms, paper_terms

__all__ = ["SingleLinkArm", "Terms", "TwoLinkArm", "paper_terms"]
