"""Only orders change a house: statements and questions in many forms, and orders in as many."""

from __future__ import annotations

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.lists.sentences import understand
from chord_usd.line.stage.author.names import name_rooms
from tests.every import for_every

STATEMENTS = (
    # complaints
    "I have no chair at the dining table", "there's no lamp", "there is no lamp in the living room",
    "the sofa is too small", "I don't like the sofa", "I hate the coffee table",
    "the bed is near the door", "the kitchen has no fridge", "there are no plants in the hall",
    "it's too small", "the sofa stands too near to the window", "we have no rug",
    "there isn't a mirror in the corridor", "my desk is too small for me",
    "I can't stand the coffee table", "the chairs are in the way", "I am tired of the sofa",
    "there are too many chairs in the dining room", "the washing machine is too loud",
    "nobody needs a television in bedroom 1",
    # observations
    "the sofa faces the window", "the sofa stands by the window", "there's a rug in the hall",
    "there are two bedside tables in bedroom 1", "the toilet is next to the washbasin",
    "a lamp stands beside the sofa", "the bed in bedroom 1 is by the wall",
    "I like the sofa", "we have two beds", "you have a desk in bedroom 2",
    "the sofa is turned to the window", "the armchair on the balcony looks out of the window",
    "the dining table has four chairs", "theres a plant by the door", "that is a large bed",
    "I put a desk in bedroom 2", "you put the sofa by the window", "the chairs face the table",
    "the sofa was by the window", "we had a mirror in the hall", "they have no desk",
    "the lamp hangs over the table", "in the hall there is a rug", "it faces the door",
    "I've two armchairs", "the rug and the lamp are in the living room",
    # negations and hedges
    "I need no rug in the hall", "the kitchen needs no table", "I do not need a desk",
    "there is no need for a lamp in bedroom 1", "no need for a desk in bedroom 2",
    "the sofa could face the window", "we could have a plant there", "the sofa may stay",
    "I don't want to move the sofa", "the kitchen and the hall have no rug",
    "I have two chairs, a desk and no lamp", "there is a sofa and no coffee table",
    "he would like a desk", "the bathtub has no window",
)  # fmt: skip

QUESTIONS = (
    "is there a mirror?", "is there a mirror", "are there any plants in the living room?",
    "do I need a desk in bedroom 2?", "does the kitchen have a fridge?", "where is the sofa?",
    "how many chairs are at the dining table?", "what is next to the toilet?",
    "should the sofa face the window?", "can the sofa face the window?", "is the sofa too large?",
    "would you like a desk in bedroom 2?", "why is the bed by the door?", "have I two beds?",
    "which room has a rug?", "who needs a lamp in the hall?", "any mirror in the hall?",
    "no lamp in bedroom 1?", "two chairs at the desk?", "a plant by the window?",
    "shall we move the sofa to the window?", "what about a lamp in bedroom 1?",
    "could there be a mirror in the hall?", "must the toilet be next to the washbasin?",
    "do we have a television in bedroom 1?", "where are the chairs", "is it by the window?",
    "remove the rug? is there a rug?", "put a plant in the hall. Is there a mirror?",
    "how about no rug in the hall?",
)  # fmt: skip

ORDERS = {
    # imperatives
    "put a desk in bedroom 2": "add", "remove the coffee table": "remove",
    "move the coffee table 0.2 m towards the TV": "move", "turn the sofa to the window": "face",
    "rotate the armchair on the balcony by 90 degrees clockwise": "turn",
    "swap the toilet and the washbasin": "swap", "make the kitchen industrial": "style",
    "lock the sofa": "lock", "replace the sofa by an armchair": "replace",
    "do move the coffee table 0.2 m north": "move", "then remove the coffee table": "remove",
    "please hang a mirror in the hall": "add", "in the living room put a plant": "add",
    "next to the sofa stand a lamp": "add", "stand a lamp beside the sofa": "add",
    "throw both nightstands in bedroom 1 out": "remove", "take the sofa away": "remove",
    "don't touch the bed in bedroom 1": "lock", "let the toilet and the washbasin swap": "swap",
    "have the easy chair outside face the door": "face", "face the sofa to the window": "face",
    "let's put a plant in the hall": "add", "kindly remove the coffee table": "remove",
    "now turn the sofa to the window": "face", "add two chairs to bedroom 2": "add",
    "put a little table between the sofa and the window": "add",
    "remove the chairs at the dining table": "remove", "keep the dining table where it is": "lock",
    "pin the dining table so that it stays put": "lock",
    "set a plant before the window in the living room": "add",
    # wishes
    "I want a desk in bedroom 2": "add", "I'd like a lamp beside the sofa": "add",
    "we need a mirror in the hall": "add", "I want no pictures in the living room": "remove",
    "I would like a plant in the living room": "add", "I'd love a plant in the hall": "add",
    "I want the sofa to face the window": "face", "I want you to remove the coffee table": "remove",
    "I'd like to move the coffee table 0.2 m towards the TV": "move",
    "we'd like two plants in the living room": "add", "bedroom 2 needs a desk": "add",
    "the kitchen needs a fridge": "add", "give me a desk in bedroom 2": "add",
    "let me have a desk in bedroom 2": "add", "I need to turn the sofa to the window": "face",
    # duties
    "the sofa should face the window": "face", "the sofa must go": "remove",
    "the couch should look out of the window": "face",
    "there should be no rug in the hall": "remove", "there must be a mirror in the hall": "add",
    "the sofa has to face the window": "face", "the sofa needs to face the window": "face",
    "you should remove the coffee table": "remove",
    "the dining table should stand nearer to the window": "move",
    "the bed in bedroom 1 stays where it is": "lock",
    "we should turn the sofa to the window": "face",
    # requests in the form of a question
    "can you put a desk in bedroom 2?": "add",
    "could you please remove the coffee table?": "remove",
    "would you turn the sofa to the window?": "face",
    "could we have a lamp beside the sofa?": "add", "can I have a plant in the hall?": "add",
    "will you remove the coffee table?": "remove",
    "may I have a mirror in the hall, please?": "add", "please put a desk in bedroom 2?": "add",
    # without a verb
    "no rug in the hall": "remove", "two dining chairs less please": "remove",
    "only four chairs around the dining table": "remove", "a lamp beside the sofa": "add",
    "bedroom 2 without the wardrobe": "remove", "kitchen: a fridge": "add",
    "one more plant in the living room": "add", "a desk in bedroom 2, please!": "add",
    # an order after a statement that says what it is about
    "I hate the coffee table, take it away": "remove",
    "the coffee table is too small, remove it": "remove",
    "the sofa faces the door, turn it to the window": "face",
    "there is a coffee table in the living room, get rid of it": "remove",
    "I have no desk, put a desk in bedroom 2": "add",
}  # fmt: skip


def actions_of(sentence: str, house: SceneGraph) -> set[str]:
    """Which actions a sentence asks for; none where it is refused."""
    rooms = {one.name: one.room for one in name_rooms(house)}
    try:
        return {one.action for one in understand(sentence, house, rooms).intents}
    except ChordError:
        return set()


@for_every("sentence", [*STATEMENTS, *QUESTIONS])
def test_a_statement_or_a_question_changes_nothing(
    sentence: str, furnished_house: SceneGraph
) -> None:
    assert not actions_of(sentence, furnished_house)


@for_every(("sentence", "action"), ORDERS.items())
def test_an_order_is_understood(sentence: str, action: str, furnished_house: SceneGraph) -> None:
    assert actions_of(sentence, furnished_house) == {action}
