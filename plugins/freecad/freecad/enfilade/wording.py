"""What the workbench says, in English and German: English sentences are the keys."""

import re
from typing import List

import FreeCAD as App

from enfilade_common.results import Note, Option

GERMAN = {
    "Enfilade": "Enfilade",
    "1 Mark": "1 Markieren",
    "2 Study": "2 Studie",
    "3 Options": "3 Varianten",
    "Nothing selected. Select walls, columns, doors or windows in the view.": "Nichts ausgewählt. Wählen Sie Wände, Stützen, Türen oder Fenster in der Ansicht.",
    "Nothing selected. Select all lines of a wall in the view.": "Nichts ausgewählt. Wählen Sie alle Linien einer Wand in der Ansicht.",
    "Marked: {}. They move together, as '{}'.": "Markiert: {}. Sie bewegen sich gemeinsam, als '{}'.",
    "Selected: {}": "Ausgewählt: {}",
    "east-west": "Ost-West",
    "north-south": "Nord-Süd",
    "along the wall": "entlang der Wand",
    "turn": "sich drehen",
    "from": "von",
    "to": "bis",
    "Group": "Gruppe",
    "Name": "Name",
    "none; regions of one name are a pair of their own": "keiner; Bereiche eines Namens bilden ein eigenes Paar",
    "Objects with the same group name move together": "Objekte mit gleichem Gruppennamen bewegen sich gemeinsam",
    "Must stay": "Muss bleiben",
    "Allow": "Erlauben",
    "Remove marks": "Markierung entfernen",
    "Regions: select a closed line, or draw one": "Bereiche: geschlossene Linie auswählen oder zeichnen",
    "People are here": "Hier sind Menschen",
    "They look at this": "Dorthin sollen sie sehen",
    "Nothing moves here": "Hier bewegt sich nichts",
    "What should get better, most important first": "Was besser werden soll, Wichtigstes zuerst",
    "Asked of rooms": "Von Räumen verlangt",
    "What rooms must have, parted by semicolons. Options that break it are left out.": "Was Räume haben müssen, durch Semikolon getrennt. Varianten, die es verletzen, entfallen.",
    "See more (visibility)": "Mehr sehen (Sichtbarkeit)",
    "See less (visibility)": "Weniger sehen (Sichtbarkeit)",
    "Fewer steps (turns)": "Weniger Schritte (Wendungen)",
    "More steps (turns)": "Mehr Schritte (Wendungen)",
    "Nearer corners (most steps)": "Nähere Ecken (meiste Schritte)",
    "Farther corners (most steps)": "Fernere Ecken (meiste Schritte)",
    "Opens up evenly (evenness)": "Öffnet sich gleichmäßig (Gleichmaß)",
    "Opens up unevenly (evenness)": "Öffnet sich ungleichmäßig (Gleichmaß)",
    "share of the possible gain that every option keeps": "Anteil des möglichen Gewinns, den jede Variante behält",
    "Options": "Varianten",
    "Seed": "Startzahl",
    "Layouts to measure": "Zu messende Grundrisse",
    "automatic": "automatisch",
    "Sight lines": "Sichtlinien",
    "at eye level": "in Augenhöhe",
    "at knee level": "in Kniehöhe",
    "Cell size": "Zellengröße",
    "Drawn in": "Gezeichnet in",
    "Of a plan of lines. FreeCAD takes what is drawn without a unit for millimetres.": "Bei einem Plan aus Linien. FreeCAD hält Gezeichnetes ohne Einheit für Millimeter.",
    "Storey": "Geschoss",
    "Program": "Programm",
    "found by itself": "wird selbst gefunden",
    "Run": "Starten",
    "Stop": "Anhalten",
    "Run the study to see options here.": "Starten Sie die Studie, um hier Varianten zu sehen.",
    "Present": "Bestand",
    "Option {}": "Variante {}",
    "Best found": "Beste gefundene",
    "no heat map": "keine Heatmap",
    "visibility": "Sichtbarkeit",
    "steps": "Schritte",
    "most steps": "meiste Schritte",
    "evenness": "Gleichmaß",
    "Ghost walls": "Geisterwände",
    "new place": "neuer Ort",
    "stands there now": "steht jetzt dort",
    "little": "wenig",
    "much": "viel",
    "Accept": "Übernehmen",
    "Open report": "Bericht öffnen",
    "Import as document": "Als Dokument importieren",
    "Nothing may move: {}. The options build.": "Nichts darf sich bewegen: {}. Die Varianten bauen um.",
    "Nothing may move: {}. The present layout was measured.": "Nichts darf sich bewegen: {}. Der Bestand wurde gemessen.",
    "No better layout was found within what is marked.": "Im Rahmen des Erlaubten wurde kein besserer Grundriss gefunden.",
    "This was in the document '{}', which is not the one in front.": "Das war im Dokument '{}', das nicht das vordere ist.",
    "The folder of the document cannot be written; the job lies in {}.": "In den Ordner des Dokuments kann nicht geschrieben werden; der Auftrag liegt in {}.",
    "outside any level": "außerhalb aller Geschosse",
    "Marked, but they stay: {}": "Markiert, aber sie bleiben: {}",
    "Marks removed: {}": "Markierung entfernt: {}",
    "best so far {}": "bisher bester Wert {}",
    "about {} s left": "noch etwa {} s",
    "about {} min left": "noch etwa {} min",
    "A study is running; stop it first.": "Eine Studie läuft; halten Sie sie zuerst an.",
    "Open or create a document first.": "Öffnen oder erstellen Sie zuerst ein Dokument.",
    "Stopping …": "Wird angehalten …",
    "Tick what may be done with it, name its group, or tick that it must stay.": "Kreuzen Sie an, was damit geschehen darf, nennen Sie eine Gruppe, oder kreuzen Sie an, dass es bleiben muss.",
    "What is ticked is not possible with {}.": "Was angekreuzt ist, geht nicht bei {}.",
    "May move": "Darf sich bewegen",
    "May be built": "Darf gebaut werden",
    "Where any work is marked, options build nothing else.": "Ist ein Umbau markiert, bauen die Varianten nichts anderes um.",
    "opening": "Öffnung",
    "door of 0.9 m": "Tür von 0,9 m",
    "glass": "Glas",
    "wider door or opening": "breitere Tür oder Öffnung",
    "door walled up": "Tür zugemauert",
    "door elsewhere in its wall": "Tür anderswo in ihrer Wand",
    "free end goes back": "freies Ende weicht zurück",
    "whole wall removed": "ganze Wand entfernt",
    "new wall across the room": "neue Wand quer durch den Raum",
    "several": "mehrere",
    "{} can: {}.": "{} kann: {}.",
    "move": "sich bewegen",
    "slide along the wall": "entlang der Wand gleiten",
    "get an opening": "eine Öffnung bekommen",
    "get a door": "eine Tür bekommen",
    "get glass": "Glas bekommen",
    "get wider doors and openings": "breitere Türen und Öffnungen bekommen",
    "have doors and openings walled up": "Türen und Öffnungen verlieren",
    "have doors hung elsewhere in it": "Türen an anderer Stelle bekommen",
    "become wider": "breiter werden",
    "be walled up": "zugemauert werden",
    "be hung elsewhere in its wall": "an eine andere Stelle der Wand kommen",
    "end earlier": "früher enden",
    "be removed": "entfernt werden",
    "get a new wall across the room": "eine neue Wand quer durch den Raum bekommen",
    "{}: nothing is built in what must stay.": "{}: Was bleiben muss, wird nicht umgebaut.",
    "{}: lies in a region where nothing moves.": "{}: liegt in einem Bereich, in dem sich nichts bewegt.",
    "{}: outdoors on one side, so nothing is opened or walled up.": "{}: grenzt ans Freie, darum wird nichts geöffnet oder zugemauert.",
    "{}: has no straight axis, so no part of it is opened.": "{}: hat keine gerade Achse, darum wird kein Teil davon geöffnet.",
    "{}: too short for an opening of 0.9 m.": "{}: zu kurz für eine Öffnung von 0,9 m.",
    "{}: windows are not rebuilt.": "{}: Fenster werden nicht umgebaut.",
    "{}: columns are not rebuilt.": "{}: Stützen werden nicht umgebaut.",
    "{}: stays, since {}.": "{}: bleibt, denn {}.",
    "its wall stays": "ihre Wand bleibt",
    "Marked: {}": "Markiert: {}",
    "Draw a closed line now; it becomes the region.": "Zeichnen Sie jetzt eine geschlossene Linie; sie wird zum Bereich.",
    "The region is not closed and was left as it is.": "Der Bereich ist nicht geschlossen und blieb, wie er ist.",
    "The document was closed.": "Das Dokument wurde geschlossen.",
    "Choose an option first.": "Wählen Sie zuerst eine Variante.",
    "Mark what may move": "Markieren, was sich bewegen darf",
    "Study: say what should get better": "Studie: sagen, was besser werden soll",
    "Run the study": "Studie starten",
    "Look at the options": "Varianten ansehen",
    "Accept the option": "Variante übernehmen",
    "Import a candidate": "Variante aus Datei importieren",
    "Export for the watched folder": "In den überwachten Ordner exportieren",
    "Drawings": "Zeichnungen",
    "Written to {}": "Geschrieben nach {}",
    "Document": "Dokument",
    "none": "keins",
    "Switch to '{}'": "Zu '{}' wechseln",
    "The panel works on '{}' now.": "Die Leiste arbeitet jetzt an '{}'.",
    "'{}' is in the document '{}', but the panel works on '{}'. Nothing was done: select there, or press \"Switch\" above.": "'{}' liegt im Dokument '{}', die Leiste arbeitet aber an '{}'. Nichts wurde getan: Wählen Sie dort aus, oder drücken Sie oben \"wechseln\".",
    "{} on another storey: the panel works on '{}'. Nothing was done: choose the storey above.": "{} auf einem anderen Geschoss: Die Leiste arbeitet an '{}'. Nichts wurde getan: Wählen Sie das Geschoss oben.",
    "{}: no wall, column, door or window, so it cannot move. A closed line can be a region: see below.": "{}: keine Wand, Stütze, Tür oder Fenster, kann sich also nicht bewegen. Eine geschlossene Linie kann ein Bereich sein: siehe unten.",
    "Marked here: {}": "Hier markiert: {}",
    "On other storeys, not studied here: {}": "Auf anderen Geschossen, hier nicht untersucht: {}",
    "left: {} to {}": "noch: {} bis {}",
    "Press Allow to begin anew from here.": "\"Erlauben\" beginnt von hier aus neu.",
    "'{}', storey '{}'": "'{}', Geschoss '{}'",
    "Starting {} …": "Startet: {} …",
    "Stopping: the best so far is being kept. Press Stop again to end at once.": "Wird angehalten: Das Beste bisher wird noch gesichert. Nochmals Anhalten beendet sofort.",
    "Stopped. Nothing better had been found yet.": "Angehalten. Noch war nichts Besseres gefunden.",
    "The options shown are those of the run before.": "Gezeigt werden die Varianten des Laufs davor.",
    "Stopped. Best so far: {} option.": "Angehalten. Das Beste bisher: {} Variante.",
    "Stopped. Best so far: {} options.": "Angehalten. Das Beste bisher: {} Varianten.",
    "Done: {} option.": "Fertig: {} Variante.",
    "Done: {} options.": "Fertig: {} Varianten.",
    "{} layout measured": "{} Grundriss gemessen",
    "{} layouts measured": "{} Grundrisse gemessen",
    "{} object": "{} Objekt",
    "{} objects": "{} Objekte",
    "{} note": "{} Hinweis",
    "{} notes": "{} Hinweise",
    "Opened as the document '{}': {}.": "Geöffnet als Dokument '{}': {}.",
    "Accept: {}": "Übernehmen: {}",
    "Accepted option {}: {} moved. Undo takes all of it back.": "Variante {} übernommen: {} bewegt. Rückgängig nimmt alles zurück.",
    "Accepted option {}: {}. Undo takes all of it back.": "Variante {} übernommen: {}. Rückgängig nimmt alles zurück.",
    "Accepted the best found: {}. Undo takes all of it back.": "Beste gefundene übernommen: {}. Rückgängig nimmt alles zurück.",
    "{} moved": "{} bewegt",
    "Accepted the best found: {} moved. Undo takes all of it back.": "Beste gefundene übernommen: {} bewegt. Rückgängig nimmt alles zurück.",
    "Door": "Tür",
    "Glass": "Glas",
    "Opening": "Öffnung",
    "New wall": "Neue Wand",
    "{} part": "{} Teil",
    "Measure": "Maß",
    "Now": "Jetzt",
    "Change": "Änderung",
    "Report": "Bericht",
    "Drawing behind …": "Zeichnung dahinter …",
    "Drawing behind these shapes": "Zeichnung hinter diesen Formen",
    "How is it read?": "Wie wird gelesen?",
    "Show it": "Zeigen",
    "Layers, blocks and unit from {}.": "Layer, Blöcke und Einheit aus {}.",
    "{} shapes are new or edited.": "{} Formen sind neu oder bearbeitet.",
    "Things of the file that are not here, and are left out: {}.": "Was in der Datei steht, hier fehlt und wegbleibt: {}.",
    "Things that the import lost, taken from the file: {}.": "Was der Import verlor und aus der Datei kommt: {}.",
    "The program cannot be started.": "Das Programm lässt sich nicht starten.",
    "{} is a drawing of a job, which is written anew. Choose your own.": "{} gehört zu einem Auftrag und wird neu geschrieben. Wählen Sie Ihre eigene Datei.",
    "1 shape is new or edited.": "1 Form ist neu oder bearbeitet.",
    "No DXF file is known for these shapes: they are read as drawn here.": "Zu diesen Formen ist keine DXF-Datei bekannt: Sie werden gelesen, wie sie hier gezeichnet sind.",
    "No DXF file fits these shapes. Layers and unit are unknown.": "Keine DXF-Datei passt zu diesen Formen. Layer und Einheit sind unbekannt.",
    "{} is not there.": "{} ist nicht da.",
    "{} cannot be read any more. Layers and unit are unknown.": "{} ist nicht mehr lesbar. Layer und Einheit sind unbekannt.",
    "{} does not fit these shapes: only {} % are alike. It is not used.": "{} passt nicht zu diesen Formen: Nur {} % stimmen überein. Sie wird nicht verwendet.",
    "Read in {}: {}, {}, {}.": "Gelesen in {}: {}, {}, {}.",
    "{} wall": "{} Wand",
    "{} walls": "{} Wände",
    "{} door": "{} Tür",
    "{} doors": "{} Türen",
    "{} room": "{} Raum",
    "{} rooms": "{} Räume",
    "Doors are {} m wide. Usual are {} to {} m: is the unit right?": "Türen sind {} m breit. Üblich sind {} bis {} m: Stimmt die Einheit?",
    "How wide is this door?": "Wie breit ist diese Tür?",
    "The drawing is in {}.": "Die Zeichnung ist in {}.",
}


def is_german() -> bool:
    group = App.ParamGet("User parameter:BaseApp/Preferences/General")
    return group.GetString("Language", "").startswith(("German", "Deutsch"))


def say(text: str, *values) -> str:
    """A sentence in the language of the program, with its values."""
    return (GERMAN.get(text, text) if is_german() else text).format(*values)


def count(n: int, one: str, many: str) -> str:
    """A sentence about ``n`` things."""
    return say(one if n == 1 else many, n)


#: What the program says of its files and its command line, and what it is called here.
HERE = (
    (r"\[\[move\]\] \"([^\"]*)\" names no wall of the drawing", r"no line of '\1' is read as a wall"),
    (r"\[\[move\]\] \"([^\"]*)\"", r"'\1'"),
    (r"^unit: mm as --unit.*", "Unit: mm, as in the document."),
    (r"^unit: (\w+) as --unit.*", r"Unit: \1, as page 2 says."),
    (r" \((no )?\$INSUNITS[^)]*\)", ""),
    (r"; --unit overrides it( \(.*\))?", "; 'Drawn in' on page 2 overrides it"),
    (r"--unit", "'Drawn in'"),
    (r"\bspacing (\S+ m): (\d+) vertices", r"Cell size \1: \2 cells"),
    (r"\bvertices\b", "cells"),
    (r"; --spacing overrides it", "; 'Cell size' on page 2 overrides it"),
    (r"--spacing", "'Cell size'"),
    (r"EF-QUERY or --seed-point says", "regions on page 1 say"),
    (r"EF-MOVE boxes round more walls, or wider bounds in them,", "marks on more walls, or wider bounds,"),
    (r"EF-MOVE boxes round more walls( or wider bounds in them)?", r"marks on more walls\1"),
    (r"bounds in (EF-MOVE boxes|them)", "bounds"),
    (r"EF-MOVE boxes", "marks"),
    (r"EF-MOVE", "'Allow'"),
    (r"EF-KEEP", "'Must stay'"),
    (r"EF-QUERY", "'People are here'"),
    (r"EF-REFERENCE", "'They look at this'"),
    (r"\b([Mm])ore --evaluations", r"\1ore 'Layouts to measure'"),
    (r"`--thresholds firm` keeps them", "Set a slider on page 2 to keep them"),
    (r" \(layer A-[A-Z]+\)", ""),
    (r"[;,] `--allow [^`]*` takes it on", ""),
    (r" `--allow [^`]*` (permits that|frees them)\.", ""),
)


def here(text: str) -> str:
    """What the program says, in the words of this window."""
    for pattern, words in HERE:
        text = re.sub(pattern, words, text)
    return text


def words_of(option: Option) -> str:
    """What an option is, in the words of this window: what the program says of it, and every work that it leaves out."""
    words = here(option.words)
    said = words.lower()
    works = [w.said() for w in option.works]
    return "\n".join([words, *(f"• {w[:1].upper()}{w[1:]}" for w in works if w.lower() not in said)]).strip()


def accepted(option: Option, moved: List[str]) -> str:
    """That an option was accepted: the labels of what moved, the works that were made."""
    names = ", ".join(moved)
    if not option.works:
        if not option.number:
            return say("Accepted the best found: {} moved. Undo takes all of it back.", names)
        return say("Accepted option {}: {} moved. Undo takes all of it back.", option.number, names)
    done = "; ".join([*([say("{} moved", names)] if moved else []), *(w.said() for w in option.works)])
    if not option.number:
        return say("Accepted the best found: {}. Undo takes all of it back.", done)
    return say("Accepted option {}: {}. Undo takes all of it back.", option.number, done)


def _named(line, labels) -> str:
    """A line of the job's drawing as the object that it is of."""
    label = labels.get(line.group(1), "")
    return f"'{label}'" if label else line.group(0)


def note_here(note: Note, labels) -> Note:
    """A note of the program in the words of this window: its place as the object's label, its text."""
    text = re.sub(r"\b(?:LW)?(?:POLY)?LINE ([0-9A-F]+)\b", lambda line: _named(line, labels), here(note.text))
    handle = re.search(r"(\S+) layer ", note.place)
    label = labels.get(handle.group(1), "") if handle else ""
    text = f"'{label}': {text}" if label else text[:1].upper() + text[1:]
    return Note(note.severity, label, text if text.endswith(".") else text + ".")
