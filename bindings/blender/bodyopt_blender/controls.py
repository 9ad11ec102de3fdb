"""What was learned to be driven, and the channels of modifiers, as custom properties of an object: keyed as any."""
import numpy as np

PREFIX = "bodyopt."


class Controls:
    """Those of a model: of what was learned first, then the channels."""

    def __init__(self, model):
        self.learned = list(model.control_names)
        self.channels = list(model.channels)
        self.keys = [PREFIX + name for name in self.learned + [channel[0] for channel in self.channels]]
        self.defaults = [0.0] * len(self.learned) + [channel[2] for channel in self.channels]

    def add_to(self, obj):
        """Gives an object those that it lacks, with their ranges, and takes away those of another basis."""
        for key in [key for key in obj.keys() if key.startswith(PREFIX) and key not in self.keys]:
            del obj[key]
        about = [("learned of the dataset", 0.0, 1.0)] * len(self.learned)
        about += [(what, low, high) for _, what, _, low, high in self.channels]
        for key, default, (what, low, high) in zip(self.keys, self.defaults, about):
            if key not in obj:
                obj[key] = float(default)
            obj.id_properties_ui(key).update(min=low, max=high, soft_min=low, soft_max=high, default=default,
                                             description=what)
            obj.property_overridable_library_set(f'["{key}"]', True)

    @staticmethod
    def remove_from(obj):
        """Takes all of them away."""
        for key in [key for key in obj.keys() if key.startswith(PREFIX)]:
            del obj[key]

    def read(self, obj):
        """Their values, C, float32; the default of one that was deleted."""
        return np.array([obj.get(key, default) for key, default in zip(self.keys, self.defaults)], np.float32)

    def learned_of(self, values):
        """Of values, C: one row of those of what was learned."""
        return values[None, :len(self.learned)]

    def channels_of(self, values):
        """Of values, C: one row of those of modifiers."""
        return np.ascontiguousarray(values[None, len(self.learned):])

    def of_frames(self, obj, values, frames):
        """The channels of frames, F x channels: by the object's curves, or as they are now where none moves them."""
        rows = np.repeat(self.channels_of(values), len(frames), axis=0)
        action = obj.animation_data and obj.animation_data.action
        for column, key in enumerate(self.keys[len(self.learned):]):
            if (curve := action and action.fcurves.find(f'["{key}"]')) and not curve.mute:
                rows[:, column] = [curve.evaluate(frame) for frame in frames]
        return rows

    def are_moved_by_others(self, obj):
        """Whether drivers or NLA strips move channels, of which of_frames() does not know."""
        data = obj.animation_data
        strips = [strip for track in data.nla_tracks for strip in track.strips if strip.action] if data else []
        curves = [*(data.drivers if data else ()), *(curve for strip in strips for curve in strip.action.fcurves)]
        return any(curve.data_path[2:-2] in self.keys[len(self.learned):] for curve in curves)
