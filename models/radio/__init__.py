"""Next-generation radio control: trains kept apart by reports and authorities alone, over a radio nobody trusts."""

from models.radio.crossing import Crossing, CrossingAhead
from models.radio.ground import Cell, Orders, Wish
from models.radio.messages import Arrival, Channel, Choices, Message, Slot
from models.radio.moving_block import Air, Follower, FourTrains, Report, ThreeTrains, TwoTrains
from models.radio.on_board import Drive, OnBoard, Supervised
from models.radio.points import Points, PointsAhead
from models.radio.train import Motion, SetBack, Train

__all__ = [
    "Air",
    "Arrival",
    "Cell",
    "Channel",
    "Choices",
    "Crossing",
    "CrossingAhead",
    "Drive",
    "Follower",
    "FourTrains",
    "Message",
    "Motion",
    "OnBoard",
    "Orders",
    "Points",
    "PointsAhead",
    "Report",
    "SetBack",
    "Slot",
    "Supervised",
    "ThreeTrains",
    "Train",
    "TwoTrains",
    "Wish",
]
