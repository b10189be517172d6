"""Rows of a campaign that tests write into its results."""

from sim.campaign.results.store import Status

FAILED = {"status": Status.FAILED, "failure": "no fuel", "success": False, "cells": {}, "profiles": {}}
"""What a row has where its run did not fly."""
